// Things that people and scripts expect of any command line: near misses, exit codes, events,
// colours, options from a file, and a command that says how things stand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(NearMisses, AreSuggested) {
  const std::string box = scene_file("cornell-box.glb");
  for (const auto& [arguments, says] :
       {std::pair{
            "bake " + box + " --ouput x",
            "luxel bake has no option '--ouput'; did you mean '--output'? 'luxel bake --help'"},
        std::pair{"bake " + box + " -o x --resolutoin=8", "did you mean '--resolution'?"},
        std::pair{"bake " + box + " -o x --colour red",
                  "luxel bake has no option '--colour'; 'luxel bake --help'"},
        std::pair{std::string("bkae"),
                  "there is no command 'bkae'; did you mean 'bake'? 'luxel --help'"},
        std::pair{std::string("paint"), "there is no command 'paint'; 'luxel --help'"},
        std::pair{std::string("--verison"),
                  "luxel has no option '--verison'; did you mean '--version'?"}}) {
    const CommandResult r = luxel(arguments);
    EXPECT_EQ(r.code, 2) << arguments;
    EXPECT_THAT(r.err, HasSubstr(says)) << arguments;
  }
}

TEST(Help, SaysTheExitCodes) {
  for (const char* arguments : {"--help", "bake --help", "info --help"})
    EXPECT_THAT(luxel(arguments).out, HasSubstr("Exit codes: 0 done; 1 ")) << arguments;
}

TEST(Version, NamesWhatItWasMadeOf) {
  const std::string text = luxel("--version", kNoLeakSearch).out;
  EXPECT_THAT(text, AllOf(HasSubstr("luxel 0."), HasSubstr("\ncompiler: "),
                          HasSubstr("\nray tracer: Embree 3."), HasSubstr("\ndevice: ")));
}

TEST(Doctor, SaysHowThingsStand) {
  const CommandResult text = luxel("doctor", kNoLeakSearch);
  EXPECT_EQ(text.code, 0) << text.out;
  EXPECT_THAT(text.out, HasSubstr("of its exact light"));
  const nlohmann::json all = nlohmann::json::parse(luxel("doctor --json", kNoLeakSearch).out);
  EXPECT_EQ(all["bakes"], true);
  EXPECT_GE(all["findings"].size(), 8u);
  for (const nlohmann::json& finding : all["findings"]) {
    const bool is_good = finding["state"] == "good";
    EXPECT_EQ(finding["advice"].get<std::string>().empty(), is_good) << finding;
  }
  // Where no Vulkan driver is found it says so, and bakes all the same.
  const CommandResult without = luxel("doctor", "VK_DRIVER_FILES=/none VK_ICD_FILENAMES=/none");
  EXPECT_EQ(without.code, 0);
  EXPECT_THAT(without.out, HasSubstr("lacking  graphics device"));
}

std::vector<nlohmann::json> events_in(const std::string& text) {
  std::vector<nlohmann::json> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    out.push_back(nlohmann::json::parse(line, nullptr, false));
    EXPECT_TRUE(out.back().is_object()) << "not a line of JSON: " << line;
  }
  return out;
}

TEST(Events, AreAllThatStandardErrorGets) {
  const ScratchFolder s;
  const CommandResult r =
      luxel("bake " + scene_file("furnace-box.glb") +
            " --resolution 32 --samples 16 --progress-json -o " + (s.path / "out").string());
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.out, "");
  std::vector<std::string> ended;
  size_t shown = 0;
  double overall = 0;
  for (const nlohmann::json& event : events_in(r.err)) {
    if (event["event"] == "stage") ended.push_back(event["stage"]);
    if (event["event"] != "progress") continue;
    ++shown;
    EXPECT_TRUE(event["share"].is_null() || (event["share"] >= 0 && event["share"] <= 1)) << event;
    EXPECT_TRUE(event["seconds_left"].is_null() || event["seconds_left"] >= 0) << event;
    const double now = event["overall"].is_null() ? 0 : event["overall"].get<double>();
    EXPECT_GE(now, overall) << "it never falls";
    EXPECT_LE(now, 1);
    overall = now;
  }
  EXPECT_GT(shown, 0u);
  EXPECT_THAT(ended, AllOf(Contains("import"), Contains("trace rays"), Contains("write files")));
}

// A layout is made several times, and a picture is drawn in parts.
TEST(ProgressLines, NameEachStageOnce) {
  const ScratchFolder s;
  const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") +
                                " --resolution 32 --max-error 0.1 -o " + (s.path / "out").string());
  ASSERT_EQ(r.code, 0) << r.err;
  std::map<std::string, int> times;
  std::istringstream lines(r.err);
  for (std::string line; std::getline(lines, line);)
    if (line.find("  ") != std::string::npos) ++times[line.substr(0, line.find("  "))];
  for (const char* stage : {"import", "charts", "trace rays", "bounces", "draw", "write files"})
    EXPECT_EQ(times[stage], 1) << stage << '\n' << r.err;
}

TEST(Events, AreErrorsAndWarnings) {
  const ScratchFolder s;
  const CommandResult wrong = luxel("info " + (s.path / "none.glb").string() + " --progress-json");
  EXPECT_EQ(wrong.code, 1);
  const std::vector<nlohmann::json> error = events_in(wrong.err);
  ASSERT_EQ(error.size(), 1u);
  EXPECT_EQ(error[0]["event"], "error");
  EXPECT_EQ(error[0]["code"], "io");
  EXPECT_EQ(error[0]["exit_code"], 1);
  EXPECT_THAT(error[0]["message"].get<std::string>(), HasSubstr("none.glb"));
  // A scene without light of its own gets a sky, and a warning.
  const auto dark = s.write("dark.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n");
  const CommandResult warned =
      luxel("bake " + dark.string() + " --resolution 8 --samples 1 --progress-json --json -o " +
            (s.path / "out").string());
  ASSERT_EQ(warned.code, 0) << warned.err;
  std::vector<std::string> warnings;
  for (const nlohmann::json& event : events_in(warned.err))
    if (event["event"] == "warning") warnings.push_back(event["message"]);
  EXPECT_EQ(nlohmann::json(warnings), nlohmann::json::parse(warned.out)["warnings"]);
  EXPECT_FALSE(warnings.empty());
}

/// Output of a command on a terminal.
std::string on_a_terminal(const std::string& environment, const std::string& arguments) {
  return shell("script -qec 'env -u NO_COLOR " + environment + " " LUXEL_BINARY " " + arguments +
               "' /dev/null")
      .out;
}

TEST(Colours, AreForTerminalsThatWantThem) {
  const std::string red = "\033[1;31mluxel:\033[0m";
  EXPECT_THAT(on_a_terminal("TERM=xterm", "info /none.glb"), HasSubstr(red));
  EXPECT_THAT(on_a_terminal("TERM=xterm NO_COLOR=1", "info /none.glb"),
              AllOf(HasSubstr("luxel: "), Not(HasSubstr("\033[1"))));
  EXPECT_THAT(on_a_terminal("TERM=dumb", "info /none.glb"),
              AllOf(HasSubstr("luxel: "), Not(HasSubstr("\033"))));
  EXPECT_THAT(luxel("info /none.glb").err, AllOf(HasSubstr("luxel: "), Not(HasSubstr("\033"))));
}

/// A scene with a luxel.toml beside it, in a folder of their own.
class OptionFiles : public ::testing::Test {
 protected:
  OptionFiles() {
    std::filesystem::create_directory(folder);
    std::filesystem::copy_file(scene_file("cornell-box.glb"), folder / "scene.glb");
  }
  void write(const std::string& text) const { s.write("scenes/luxel.toml", text); }
  CommandResult bake(const std::string& more) const {
    return luxel("bake " + (folder / "scene.glb").string() + " -o " + out().string() + " " + more);
  }
  std::filesystem::path out() const { return s.path / "out"; }
  nlohmann::json settings() const {
    return nlohmann::json::parse(slurp(out() / "bake.json")).at("settings");
  }

  ScratchFolder s;
  std::filesystem::path folder = s.path / "scenes";
};

TEST_F(OptionFiles, BesideASceneAreReadAndSaid) {
  write(R"(
[bake]
resolution = 24
samples = 4
max_error = 0.5              # as bake.json writes it
background = [0.1, 0.2, 0.3]
formats = "exr,hdr"
stitch = false
denoise = true
)");
  const CommandResult r = bake("--samples 3");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("luxel.toml: --background=0.1,0.2,0.3 --denoise --formats=exr,hdr "
                               "--max-error=0.5 --resolution=24 --no-stitch"));
  const nlohmann::json given = settings();
  EXPECT_EQ(given["resolution"], 24);
  EXPECT_EQ(given["samples"], 3);  // the command line wins
  EXPECT_EQ(given["max_error"], 0.5);
  EXPECT_EQ(given["background"], nlohmann::json({0.1, 0.2, 0.3}));
  EXPECT_EQ(given["stitch"], false);
  EXPECT_EQ(given["denoise"], true);
  // A setting that contradicts an option of the command line gives way, too.
  const CommandResult sky = bake("--samples 3 --sky 135,40");
  ASSERT_EQ(sky.code, 0) << sky.err;
  EXPECT_FALSE(settings().contains("background") && !settings()["background"].is_null());
  const CommandResult none = bake("--settings none --resolution 16 --samples 2 --quiet");
  ASSERT_EQ(none.code, 0) << none.err;
  EXPECT_EQ(none.err, "");
  EXPECT_EQ(settings()["stitch"], true);
}

TEST_F(OptionFiles, HaveTablesForSolversAndCommands) {
  write(R"(
[bake]
resolution = 16
samples = 2
[bake.hemicube]
hemicube = 16
max-elements = 100
[render]
size = "32x24"
)");
  ASSERT_EQ(bake("").code, 0);
  EXPECT_EQ(settings()["solver"], "gather");
  const CommandResult picture =
      luxel("render " + (folder / "scene.glb").string() + " --json --from " + out().string() +
            " -o " + (s.path / "a.png").string());
  ASSERT_EQ(picture.code, 0) << picture.err;
  EXPECT_THAT(picture.err, HasSubstr("options from"));
  EXPECT_EQ(nlohmann::json::parse(picture.out)["width"], 32);
  // Without --samples, which hemicube does not look at.
  const CommandResult r = bake("--solver hemicube");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(settings()["hemicube"]["resolution"], 16);
  EXPECT_EQ(settings()["resolution"], 16);
}

TEST_F(OptionFiles, GiveWayToWhatContradictsThem) {
  write(R"(
[bake]
resolution = 16
samples = 3
keep = true
[render]
eye = "0,1,3"
look-at = "0,1,0"
)");
  const CommandResult dense = bake("--texels-per-metre 3 --time-budget 30");
  ASSERT_EQ(dense.code, 0) << dense.err;
  EXPECT_EQ(settings()["keep"], false);
  EXPECT_EQ(settings()["texels_per_metre"], 3.0);
  const CommandResult draft = bake("--quality draft");
  ASSERT_EQ(draft.code, 0) << draft.err;
  EXPECT_GT(settings()["samples"], 3);
  const CommandResult top =
      luxel("render " + (folder / "scene.glb").string() + " --view top --size 16x16 --from " +
            out().string() + " -o " + (s.path / "a.png").string());
  EXPECT_EQ(top.code, 0) << top.err;
}

TEST_F(OptionFiles, SayWhatIsWrongAndWhere) {
  s.write("above.ies", "");
  for (const auto& [text, says] :
       {std::pair{"[bake]\nresolutoin = 4\n",
                  "line 2: luxel bake has no option 'resolutoin'; did you mean 'resolution'?"},
        std::pair{"[bake]\n\nsamples = {}\n", "line 3: samples must be a text in quotes, a number"},
        std::pair{"[bake]\nsamples = true\n", "line 2: samples must be a text"},
        std::pair{"[bake]\ndenoise = 3\n", "line 2: denoise must be true or false"},
        std::pair{"[bake]\nsamples = \"many\"\n", "luxel.toml: --samples: many is not a number"},
        std::pair{"[bake]\nview = \"\"\n", "line 2: view is empty"},
        std::pair{"[bake]\nmax-memory = \"1000G\"\n", "or in a file given by --settings"},
        std::pair{"[bake]\nsamples = 0\n", "--samples 0 is outside 1 to"},
        std::pair{"[baek]\nsamples = 3\n", "'baek' reads this file; did you mean 'bake'?"},
        std::pair{"[merge]\nmax-memory = 3\n", "no command 'merge' reads this file"},
        std::pair{"samples = 3\n", "'samples' is outside any table"},
        std::pair{"[bake\n", "luxel.toml, line 1: "},
        std::pair{"[bake]\noutput = \"/tmp\"\n", "output belongs on the command line"},
        std::pair{"[bake]\ntrust-paths = true\n", "trust-paths belongs on the command line, or in"},
        std::pair{"[bake]\nany-format = true\n", "any-format belongs on the command line, or in"},
        std::pair{"[bake]\nsearch-path = \"/usr\"\n", "/usr lies outside this file's folder"},
        std::pair{"[bake]\nies = [\"lamp=../above.ies\"]\n", "../above.ies lies outside"},
        std::pair{"[bake]\nenvironment = \"out/../../above.ies\"\n", " does not exist"},
        std::pair{"[bake]\nenvironment = \"/etc/passwd,30,2\"\n", "lies outside"}}) {
    write(text);
    const CommandResult r = bake("");
    EXPECT_TRUE(r.code == 1 || r.code == 2) << text << r.err;
    EXPECT_THAT(r.err, HasSubstr(says)) << text;
    EXPECT_FALSE(std::filesystem::exists(out())) << text;
  }
}

TEST_F(OptionFiles, AreNoLinksFromElsewhere) {
  s.write("other.toml", "[bake]\nsamples = 1\n");
  std::filesystem::create_symlink(s.path / "other.toml", folder / "luxel.toml");
  EXPECT_THAT(bake("").err, HasSubstr("is a link to another folder"));
}

TEST_F(OptionFiles, NameFilesFromTheirOwnFolderOn) {
  std::string map = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
  for (int pixel = 0; pixel < 8; ++pixel) map += "\x80\x80\x80\x81";
  s.write("scenes/sky,a.hdr", map), s.write("above.hdr", map);
  write("[bake]\nresolution = 16\nsamples = 1\nenvironment = \"sky,a.hdr,30,2\"\n");
  const CommandResult r = bake("");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(settings()["environment"]["rotation_deg"], 30.0);
  // A link is where it leads to.
  std::filesystem::create_symlink(s.path / "above.hdr", folder / "link.hdr");
  write("[bake]\nresolution = 16\nsamples = 1\nenvironment = \"link.hdr\"\n");
  EXPECT_THAT(bake("").err, HasSubstr("link.hdr lies outside this file's folder"));
  // The file that is checked is the one that is read: "link.hdr" here, whatever else is there.
  s.write("scenes/link.hdr,30", map);
  write("[bake]\nresolution = 16\nsamples = 1\nenvironment = \"link.hdr,30\"\n");
  EXPECT_THAT(bake("").err, HasSubstr("link.hdr lies outside this file's folder"));
  // A file that was named on the command line may.
  const CommandResult named = bake("--settings " + (folder / "luxel.toml").string());
  EXPECT_EQ(named.code, 0) << named.err;
}

}  // namespace
}  // namespace luxel::testing_support
