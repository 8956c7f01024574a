// `luxel relight` from outside: the file it makes, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/export/baked_glb.h"
#include "luxel/scene/shapes.h"
#include "tests/relight_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

TEST(RelightCommand, SaysWhatItMade) {
  const ScratchFolder s;
  const CommandResult r = make(s.path / "a.lxr", "--json --max-error 0.05");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path), std::set<std::string>{"a.lxr"});
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["settings"]["patches"], 300);
  EXPECT_EQ(json["settings"]["rays"], 256);
  EXPECT_EQ(json["settings"]["codec"], "hierarchical");
  EXPECT_EQ(json["settings"]["max_error"], 0.05);
  EXPECT_EQ(json["settings"]["bounces"], -1);
  EXPECT_EQ(json["settings"]["target"], "texels");
  EXPECT_NEAR(double(json["counts"]["patches"]), 300, 45);  // within 15 %, docs/method/matrix.md
  EXPECT_GT(json["counts"]["places"], 100);
  EXPECT_LE(json["counts"]["places"], 32 * 32);
  EXPECT_EQ(json["counts"]["triangles"], 38);  // info's
  EXPECT_EQ(json["bytes"]["file"], std::filesystem::file_size(s.path / "a.lxr"));
  EXPECT_LT(json["bytes"]["matrix"], json["bytes"]["file"]);
  EXPECT_GT(double(json["usual_codec_error"]), 0);
  EXPECT_LE(double(json["usual_codec_error"]), 0.05);
  EXPECT_GE(double(json["codec_error"]), double(json["usual_codec_error"]));
  // 300 patches of 256 rays err by some percent, by some ten percent where lamps come near.
  for (const char* light : {"scene_lights", "point_lights"}) {
    EXPECT_GT(double(json["indirect_error"][light]), 0.01) << light;
    EXPECT_LT(double(json["indirect_error"][light]), 0.6) << light;
  }
  EXPECT_GT(double(json["seconds"]["form factors"]), 0);
  EXPECT_TRUE(json["warnings"].empty());
}

TEST(RelightCommand, EveryCodecCanBePlayed) {
  const ScratchFolder s;
  const auto moves = s.write("moves.json", kMoves);
  std::set<std::string> files;
  for (const char* codec : {"hierarchical", "lowrank", "bc1", "dense32", "dense16"}) {
    const auto lxr = s.path / (std::string(codec) + ".lxr");
    const CommandResult r = make(lxr, std::string("--codec ") + codec);
    ASSERT_EQ(r.code, 0) << codec << r.err;
    ASSERT_EQ(play(lxr, moves, s.path / codec).code, 0) << codec;
    // Codecs differ by a few percent of the light.
    EXPECT_NEAR(mean_of(picture(s.path / codec / "frame-0000.png"), 0, 32),
                mean_of(picture(s.path / "hierarchical" / "frame-0000.png"), 0, 32), 5)
        << codec;
    files.insert(slurp(lxr));
  }
  EXPECT_EQ(files.size(), 5u);
}

TEST(RelightCommand, TexelsAndVerticesShowTheSameLight) {
  const ScratchFolder s;
  const auto moves = s.write("moves.json", kMoves);
  for (const char* target : {"texels", "vertices"}) {
    ASSERT_EQ(make(s.path / "a.lxr", std::string("--target ") + target).code, 0) << target;
    const CommandResult r = play(s.path / "a.lxr", moves, s.path / target);
    ASSERT_EQ(r.code, 0) << target << r.err;
  }
  // The box has vertices in its corners alone, whose light is not that of the middle of its walls:
  // indirect light, a third of all, may be off by a third.
  const double texels = mean_of(picture(s.path / "texels" / "frame-0000.png"), 0, 32);
  const double vertices = mean_of(picture(s.path / "vertices" / "frame-0000.png"), 0, 32);
  EXPECT_NEAR(vertices, texels, 0.11 * texels);
}

TEST(RelightCommand, GivesTheSameBitsWithAnyNumberOfThreads) {
  const ScratchFolder s;
  const auto moves = s.write("moves.json", kMoves);
  for (const char* threads : {"1", "2"}) {
    const auto lxr = s.path / (std::string(threads) + ".lxr");
    ASSERT_EQ(make(lxr, std::string("--threads ") + threads).code, 0);
    ASSERT_EQ(play(lxr, moves, s.path / threads, std::string("--threads ") + threads).code, 0);
  }
  EXPECT_EQ(slurp(s.path / "1.lxr"), slurp(s.path / "2.lxr"));
  for (const char* frame : {"frame-0000.png", "frame-0003.png"})
    EXPECT_EQ(slurp(s.path / "1" / frame), slurp(s.path / "2" / frame)) << frame;
}

// A lamp of 1e30 W/sr is held at the distance of the sun, not in a box of half a metre.
TEST(RelightCommand, LightOfAScriptThatOverflowsIsASentence) {
  const ScratchFolder s;
  ASSERT_EQ(make(s.path / "a.lxr", "--codec dense16").code, 0);
  const auto script = s.write("bright.json", R"({"frames": 1, "size": [16, 12], "lights": [
      {"position": [0.27, 0.27, 0.27], "intensity": [1e30, 1e30, 1e30]}]})");
  const CommandResult r = play(s.path / "a.lxr", script, s.path / "frames");
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("is above 1e+18, too bright to store; most of it can "
                               "come from light 0, whose intensity of 1e+30"));
  EXPECT_FALSE(std::filesystem::exists(s.path / "frames"));
}

// A lamp may come behind a sheet of a file that has none yet, as a sky may.
TEST(RelightCommand, SheetsHaveTwoSidesInAFileWithoutLight) {
  scene::Scene sheet;
  const uint32_t cloth = scene::add_material(sheet, "cloth", {0.5f, 0.5f, 0.5f});
  sheet.materials[cloth].double_sided = true;
  scene::add_rectangle(sheet, {0, 1, 0, 1}, 1, true, cloth);
  const auto glb = export_::scene_glb(sheet);
  ASSERT_TRUE(glb);
  const ScratchFolder s;
  const auto file = s.path / "sheet.glb";
  ASSERT_TRUE(write_file_atomically(file, *glb));
  const CommandResult r =
      luxel("relight " + file.string() + kSmall + "--json -o " + (s.path / "a.lxr").string());
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(nlohmann::json::parse(r.out)["counts"]["triangles"], 4);  // two, and their backs
}

TEST(RelightCommand, RefusesWhatCannotBeMade) {
  const ScratchFolder s;
  for (const auto& [options, sentence] :
       {std::pair{"--codec zip", "--codec zip is not known; choose from: hierarchical, "},
        std::pair{"--codec bc1 --patches 30000", "--patches 30000 are too many for --codec bc1"},
        std::pair{"--target faces", "--target faces is not known; choose from: texels, "},
        std::pair{"--max-error 2", "--max-error 2 is outside 0.00001 to 1"},
        std::pair{"--max-error 0", "--max-error 0 is outside"},
        std::pair{"--bounces 2000", "--bounces 2000 is outside 0 to 1000"},
        std::pair{"--patches 0", "--patches 0 is outside 1 to"},
        std::pair{"--rays 0", "--rays 0 is outside 1 to"},
        std::pair{"--resolution 0", "--resolution 0 is outside"},
        std::pair{"--texels-per-metre -1", "--texels-per-metre -1 is not a density"},
        std::pair{"--max-memory 1M", "1 MiB may be used; lower"},
        std::pair{"--script moves.json", "--script is for --play FILE.lxr"}}) {
    const CommandResult r =
        luxel("relight " + kBox + " " + options + " -o " + (s.path / "a.lxr").string());
    EXPECT_EQ(r.code, std::string(options).find("memory") != std::string::npos ? 3 : 1) << options;
    EXPECT_THAT(r.err, HasSubstr(sentence)) << options;
    EXPECT_TRUE(files_in(s.path).empty()) << options;
  }
  const std::string here = (s.path / "a").string();
  EXPECT_THAT(luxel("relight " + kBox + " -o " + here + ".txt").err,
              HasSubstr("a.txt: the name of the file must end in .lxr"));
  EXPECT_THAT(luxel("relight -o " + here + ".lxr").err, HasSubstr("give a SCENE"));
  EXPECT_THAT(luxel("relight nothing.glb -o " + here + ".lxr").err, HasSubstr("no such file"));
  EXPECT_EQ(luxel("relight " + kBox).code, 2);  // no -o
  EXPECT_TRUE(files_in(s.path).empty());
}

}  // namespace
}  // namespace luxel::testing_support
