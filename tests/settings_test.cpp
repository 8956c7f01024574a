// A bake.json's settings given back: `luxel bake --settings`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using testing::HasSubstr;

CommandResult bake(const std::string& options, const std::filesystem::path& output) {
  return luxel("bake " + options + " --quiet -o " + output.string());
}

nlohmann::json settings_in(const std::filesystem::path& folder) {
  return nlohmann::json::parse(slurp(folder / "bake.json")).at("settings");
}

// Numbers, names, switches, texts and a solver's own options, none of them the default.
TEST(GivenSettings, MakeTheSameBake) {
  const ScratchFolder s;
  for (const std::string options :
       {"--resolution 32 --samples 20 --direct-samples 7 --bounces 2 --seed 5 --uv unwrap "
        "--no-stitch --formats exr,rgbm --sun 120,40,5",
        "--solver matrix --resolution 32 --patches 500 --rays 100 --background 1,0.5,0.25",
        "--solver hemicube --resolution 32 --elements triangle --max-elements 300 --smooth"}) {
    SCOPED_TRACE(options);
    const auto first = s.path / "first", second = s.path / "second";
    const CommandResult given = bake(scene_file("cornell-box.glb") + " " + options, first);
    ASSERT_EQ(given.code, 0) << given.err;
    const CommandResult back = bake("--settings " + (first / "bake.json").string(), second);
    ASSERT_EQ(back.code, 0) << back.err;
    EXPECT_EQ(settings_in(first), settings_in(second));
    EXPECT_EQ(slurp(first / "lightmap.exr"), slurp(second / "lightmap.exr"));
  }
}

TEST(GivenSettings, GiveWayToOptions) {
  const ScratchFolder s;
  const auto file = s.write("s.json", R"({"samples": 300, "resolution": 16, "seed": 3})");
  const CommandResult r = bake(
      scene_file("cornell-box.glb") + " --samples 4 --settings " + file.string(), s.path / "out");
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json settings = settings_in(s.path / "out");
  EXPECT_EQ(settings.at("samples"), 4);
  EXPECT_EQ(settings.at("resolution"), 16);
  EXPECT_EQ(settings.at("seed"), 3);
}

TEST(GivenSettings, ThatMeanNothingAreRefused) {
  const ScratchFolder s;
  for (const auto& [text, says] :
       {std::pair{"no json", "is not JSON"}, std::pair{"[1]", "it has no settings"},
        std::pair{R"({"sampels": 4})", "there is no setting 'sampels'"},
        std::pair{R"({"matrix": {"elements": "vertex"}})", "'matrix.elements'"},
        std::pair{R"({"samples": 0})", "--samples 0 is outside 1 to"},
        std::pair{R"({"samples": {}})", "--samples"}, std::pair{R"({"stitch": 1})", "stitch"},
        std::pair{R"({"uv": "none"})", "--uv none is not known"},
        std::pair{R"({"solver": 3})", "the wrong type"},
        std::pair{R"({"formats": "exr,jpg"})", "jpg"}}) {
    const auto file = s.write("s.json", text);
    const CommandResult r =
        bake(scene_file("cornell-box.glb") + " --settings " + file.string(), s.path / "out");
    EXPECT_TRUE(r.code == 1 || r.code == 2) << text << " " << r.err;
    EXPECT_THAT(r.err, HasSubstr(says)) << text;
    EXPECT_THAT(r.err, HasSubstr("s.json")) << text;
    EXPECT_FALSE(std::filesystem::exists(s.path / "out")) << text;
  }
}

// Scripts read stdout: one object there, whatever goes wrong, with the sentence of stderr.
TEST(JsonErrors, AreOneObject) {
  const ScratchFolder s;
  const std::string missing = (s.path / "missing.glb").string(),
                    box = scene_file("cornell-box.glb");
  const std::string out = (s.path / "out").string();
  for (const auto& [arguments, code] :
       {std::pair{"bake " + missing + " -o " + out, "io"},
        std::pair{"bake " + box + " -o " + out + " --samples 0", "bad_setting"},
        std::pair{"bake " + box + " -o " + out + " --max-memory 1M", "out_of_memory"},
        std::pair{"bake " + box + " -o " + out + " --no-such-option", "usage"},
        std::pair{"render " + missing + " --technique path -o " + out + ".png", "io"},
        std::pair{"compare " + missing + " " + missing, "io"},
        std::pair{"compare " + missing + " " + missing + " --max-flip -1", "usage"},
        std::pair{"info " + missing, "io"},
        std::pair{"factors " + missing + " -o " + out + ".csv", "io"},
        std::pair{"probe " + missing + " --at 0,0,0", "io"},
        std::pair{"relight " + missing + " -o " + out + ".lxr", "io"},
        std::pair{"relight --play " + missing + " -o " + out, "bad_setting"},
        std::pair{std::string("no-such-command"), "usage"}}) {
    SCOPED_TRACE(arguments);
    const CommandResult r = luxel(arguments + " --json --quiet");
    const nlohmann::json error = nlohmann::json::parse(r.out, nullptr, false);
    ASSERT_TRUE(error.is_object()) << r.out;
    EXPECT_EQ(error["error"]["code"], code);
    EXPECT_EQ(error["error"]["exit_code"], r.code);
    EXPECT_NE(r.code, 0);
    EXPECT_EQ("luxel: " + error["error"]["message"].get<std::string>() + "\n", r.err);
  }
}

}  // namespace
}  // namespace luxel::testing_support
