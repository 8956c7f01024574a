// Every option of every command, one at a time, with a scene in which a light has a profile.
// Nothing may end the program but itself: code 0, or a code with a sentence. The lists of options
// are those that --help prints, so that no new one is forgotten.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

using Options = std::map<std::string, std::string>;  ///< flag -> value, "" for none

/// A command with what it needs, and small numbers where it would take long.
struct Subject {
  std::string name, command;
  Options given;
};

/// Files that the options' values name, and those that the commands start from.
struct Inputs {
  ScratchFolder folder;
  std::string scene, ies, map, bake, other_bake, part, lxr, script, bake_json;
  Options makers;  ///< file or folder -> the command that makes it
};

/// Options of a bake that act before or after its solver: with gather each alone, with every other
/// solver all of a row at once.
const std::vector<std::vector<std::string>> kBesideTheSolver{
    {"--ambient-occlusion", "--attach", "--directional", "--formats", "--html", "--no-stitch",
     "--probes", "--shadow-mask", "--texels", "--view"},
    {"--background", "--environment", "--json", "--progress-json", "--quiet", "--search-path",
     "--smooth-normals", "--sun", "--trust-paths", "--any-format"},
};

const Options kSmallGather{{"--resolution", "16"}, {"--samples", "4"}, {"--direct-samples", "2"}};

std::string text_of(const Options& options) {
  std::string out;
  for (const auto& [flag, value] : options) out += " " + flag + (value.empty() ? "" : " " + value);
  return out;
}

/// The flags that `luxel COMMAND --help` lists, each by its long name.
std::vector<std::string> flags_of(const std::string& command) {
  std::istringstream help(luxel(command + " --help").out);
  std::vector<std::string> flags;
  for (std::string line; std::getline(help, line);) {
    if (!line.starts_with("  -")) continue;
    const size_t at = line.find("--");
    const size_t end = line.find_first_of(" =,", at);
    flags.push_back(line.substr(at, end - at));
  }
  return flags;
}

/// The flags that are given together with `flag`; none if another of them stands for all.
std::vector<std::string> given_with(const std::string& flag, const std::string& command) {
  if (!command.starts_with("bake ") || command.find(" --solver ") == std::string::npos)
    return {flag};
  for (const std::vector<std::string>& row : kBesideTheSolver)
    if (std::ranges::find(row, flag) != row.end())
      return flag == row[0] ? row : std::vector<std::string>();
  return {flag};
}

/// Values of options: for a command alone ("probe --samples"), or for all.
Options values_of(const Inputs& in) {
  return {
      {"--ambient-occlusion", "0.5"},
      {"--at", "0.3,0,0.4"},
      {"--attach", "emissive"},
      {"--background", "0.1,0.2,0.3"},
      {"--bounces", "2"},
      {"--boundary", "0.2"},
      {"--camera", "none"},
      {"--checkpoint", "1"},
      {"--codec", "lowrank"},
      {"--denoise", ""},
      {"--direct-samples", "3"},
      {"--device", "auto"},
      {"--devices", ""},
      {"--directional", "sh1"},
      {"--element-size", "0.5"},
      {"--elements", "triangle"},
      {"--environment", in.map},
      {"--eps", "0.5"},
      {"--error-map", ""},
      {"--error-measure", "rms"},
      {"--exposure", "0"},
      {"compare --exposure", "2"},
      {"--eye", "0,1,3 --look-at 0,0.5,0"},
      {"--floor", "0"},
      {"--formats", "exr,hdr,rgbm,rgbe,half,ktx2"},
      {"--fov-deg", "60 --eye 0,1,3 --look-at 0,0.5,0"},
      {"--from", in.bake},
      {"factors --from", "'wall and floor'"},
      {"--hemicube", "16"},
      {"--html", ""},
      {"--ies", "middle=" + in.ies + ",2"},
      {"--in-air", ""},
      {"--json", ""},
      {"--keep", ""},
      {"--layers", "per-light"},
      {"--light", "indirect"},
      {"--look-at", "0,0.5,0 --eye 0,1,3"},
      {"--max-elements", "100"},
      {"--max-error", "0.1"},
      {"--max-flip", "2"},
      {"--max-flip-p95", "2"},
      {"--max-leaf-lines", "2"},
      {"--max-memory", "1G"},
      {"--max-relative-p95", "100"},
      {"--max-relative-rmse", "100"},
      {"--max-rmse-over-mean", "100"},
      {"--method", "rays"},
      {"--min-area", "0.1"},
      {"--min-weight", "0.1"},
      {"--no-denoise", ""},
      {"--no-discontinuities", ""},
      {"--no-leak-repair", ""},
      {"--no-stitch", ""},
      {"--normal", "0,1,0"},
      {"--overlay", "mesh,links,discontinuities,triangulation,error,samples"},
      {"--pages", "mesh"},
      {"--part", "1/2"},
      {"--patches", "40"},
      {"--plan", ""},
      {"--plane", "0.5"},
      {"--probes", "0.8"},
      {"--processes-per-node", "2"},
      {"--progress-json", ""},
      {"--quality", "draft"},
      {"--quiet", ""},
      {"--ranking", "nearness"},
      {"--rays", "64"},
      {"--report", (in.folder.path / "report").string()},
      {"--resolution", "8"},
      {"--resume", ""},
      {"--samples", "5"},
      {"lux --samples", "40"},
      {"--scene", in.scene},
      {"--script", in.script},
      {"--search-path", in.folder.path.string()},
      {"--seed", "7"},
      {"--settings", "none"},
      {"bake --settings", in.bake_json},
      {"--shadow-mask", "auto"},
      {"--size", "40x30"},
      {"--sky", "135,45"},
      {"--smooth", ""},
      {"--smooth-normals", "40"},
      {"--solver", "hemicube"},
      {"probe --solver", "hierarchical"},
      {"--spacing", "0.5"},
      {"--sun", "30,40,1000"},
      {"--supersample", "2"},
      {"--target", "vertices"},
      {"--technique", "irradiance"},
      {"--texels", ""},
      {"--texels-per-metre", "4"},
      {"--threads", "1"},
      {"--time-budget", "5"},
      {"--to", "'wall and floor'"},
      {"--trust-paths", ""},
      {"--any-format", ""},
      {"--unit", "m"},
      {"--up", "y"},
      {"--tolerance", "0.01"},
      {"--tone-map", "filmic"},
      {"--uv", "unwrap"},
      {"--vertex-colors", ""},
      {"--view", "front"},
  };
}

/// Words that may explain an exit code other than 0.
const std::vector<std::string> kReasons{
    "does not use",             // an option of another solver or technique
    "has no meaning with",      // the same, in luxel factors
    "leave",                    // two options that contradict each other
    "is for",                   // the same
    "needs",                    // an option that goes with another
    "xcludes",                  // "Excludes:" of the help
    "is not in",                // no such camera
    "belongs to another bake",  // parts that were made without it
    "only the factors of a closed enclosure",
    "the name of the picture must end in",
};

bool is_known(const CommandResult& r) {
  for (const std::string& reason : kReasons)
    if (r.err.find(reason) != std::string::npos) return true;
  return false;
}

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

class SlowEveryOption : public ::testing::TestWithParam<Subject> {
 protected:
  static void SetUpTestSuite() {
    in = new Inputs;
    const std::filesystem::path scenes = std::filesystem::path(LUXEL_SOURCE_DIR) / "scenes";
    const std::filesystem::path& folder = in->folder.path;
    in->scene = (scenes / "ies" / "wall.gltf").string();
    in->ies = (scenes / "ies" / "spot.ies").string();
    in->bake = (folder / "bake").string(), in->other_bake = (folder / "other_bake").string();
    in->bake_json = in->bake + "/bake.json", in->lxr = (folder / "a.lxr").string();
    // Four times two pixels of grey.
    std::string map = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int pixel = 0; pixel < 8; ++pixel) map += "\x80\x80\x80\x81";
    in->map = in->folder.write("sky.hdr", map).string();
    in->script = in->folder
                     .write("script.json", R"({"frames": 1, "size": [40, 30],
                       "lights": [{"position": [0, 1, 1], "intensity": [1, 1, 1]}]})")
                     .string();
    in->part = (folder / "parts" / "part-1-of-1.luxel").string();
    const std::string scene = in->scene + text_of(kSmallGather) + " --quiet ";
    in->makers = {
        {in->bake, "bake " + scene + "-o " + in->bake + with_profile()},
        {in->other_bake, "bake " + scene + "-o " + in->other_bake},
        {in->part, "bake " + scene + "--part 1/1 -o " + (folder / "parts").string()},
        {in->lxr, "relight " + in->scene + " --patches 40 --rays 64 --resolution 8 -o " + in->lxr}};
  }
  static void TearDownTestSuite() { delete in; }
  static std::string with_profile() { return " --ies left=" + in->ies; }

  /// SCENE and FOLDER in a subject's command stand for paths that are made for this test.
  std::string command_of(const Subject& subject) const {
    std::string out = subject.command;
    const auto put = [&](const std::string& word, const std::string& value) {
      for (size_t at; (at = out.find(word)) != std::string::npos;)
        out.replace(at, word.size(), value);
    };
    put("SCENE", in->scene), put("PROFILE", with_profile()), put("OTHERBAKE", in->other_bake);
    put("BAKE", in->bake), put("PART", in->part), put("LXR", in->lxr), put("SCRIPT", in->script);
    put("OUT", (in->folder.path / "out").string());
    return out;
  }

  /// Runs luxel when all that its options name is there.
  static CommandResult run(const std::string& options) {
    for (const auto& [file, maker] : in->makers) {
      if (options.find(file) == std::string::npos || std::filesystem::exists(file)) continue;
      EXPECT_EQ(luxel(maker).code, 0) << maker;
    }
    return luxel(options);
  }

  static Inputs* in;
};
Inputs* SlowEveryOption::in = nullptr;

TEST_P(SlowEveryOption, EndsWithACodeAndASentence) {
  const Subject& subject = GetParam();
  const std::string command = subject.command.substr(0, subject.command.find(' '));
  const Options values = values_of(*in);
  const std::string base = command_of(subject);
  // Without any: the subject itself works.
  const CommandResult plain = run(base + text_of(subject.given));
  ASSERT_EQ(plain.code, 0) << plain.err;
  size_t done = 0;
  for (const std::string& first : flags_of(command)) {
    // Each subject has its output and, where it must, the option that makes it.
    if (first == "--help" || first == "--output" || first == "--play") continue;
    if (base.find(" " + first + " ") != std::string::npos) continue;
    const std::vector<std::string> flags = given_with(first, base);
    if (flags.empty()) continue;
    Options options = subject.given;
    for (const std::string& flag : flags) {
      auto value = values.find(command + " " + flag);
      if (value == values.end()) value = values.find(flag);
      ASSERT_NE(value, values.end()) << "give values_of() one for " << flag;
      options[flag] = value->second;
    }
    const std::string line = base + text_of(options);
    SCOPED_TRACE("luxel " + line);
    const CommandResult r = run(line);
    EXPECT_THAT(r.err, Not(HasSubstr("internal error")));
    EXPECT_THAT(r.code, AnyOf(0, 1, 2, 3));
    if (r.code != 0) {
      EXPECT_EQ(flags.size(), 1u) << "others are not tried: " << r.err;
      EXPECT_TRUE(is_known(r)) << r.code << ": " << r.err;
    } else {
      ++done;
    }
  }
  EXPECT_GT(done, 1u) << "hardly any option goes with this command";
}

// A sheet of all techniques at once.
TEST(SlowEveryTechnique, DrawsALightWithAProfile) {
  const ScratchFolder s;
  const std::string folder = LUXEL_SOURCE_DIR "/scenes/ies/";
  const CommandResult r =
      luxel("render " + folder + "wall.gltf --ies left=" + folder +
            "spot.ies --technique all --size 16x12 --samples 2" +
            " --hemicube 8 --max-elements 200 --eps 2 -o " + s.path.string() + "/all.png");
  EXPECT_EQ(r.code, 0) << r.err;
}

const Options kSmallRender{{"--size", "16x12"}};
const Options kCoarse{{"--eps", "2"}, {"--no-discontinuities", ""}, {"--min-area", "0.2"}};

INSTANTIATE_TEST_SUITE_P(
    Commands, SlowEveryOption,
    ::testing::Values(
        Subject{"BakeByGather", "bake SCENE PROFILE -o OUT", kSmallGather},
        Subject{"BakeByHemicube",
                "bake SCENE PROFILE -o OUT --solver hemicube ",
                {{"--resolution", "16"}, {"--hemicube", "8"}, {"--max-elements", "200"}}},
        Subject{"BakeByMatrix",
                "bake SCENE PROFILE -o OUT --solver matrix ",
                {{"--resolution", "16"}, {"--patches", "40"}, {"--rays", "64"}}},
        Subject{"BakeByHierarchical",
                "bake SCENE PROFILE -o OUT --solver hierarchical ",
                {{"--resolution", "16"}, {"--eps", "2"}, {"--no-discontinuities", ""}}},
        Subject{"BakeByReference",
                "bake SCENE PROFILE -o OUT --solver reference ",
                {{"--resolution", "16"}, {"--samples", "4"}}},
        Subject{"RenderALightmap", "render SCENE --from BAKE -o OUT.png", kSmallRender},
        Subject{"RenderPaths",
                "render SCENE PROFILE -o OUT.png --technique path ",
                {{"--size", "16x12"}, {"--samples", "2"}}},
        Subject{"RenderByRadiosity",
                "render SCENE PROFILE -o OUT.png --technique radiosity ",
                {{"--size", "16x12"}, {"--hemicube", "8"}, {"--max-elements", "200"}}},
        Subject{"RenderByRayshade",
                "render SCENE PROFILE -o OUT.png --technique rayshade ",
                {{"--size", "16x12"}, {"--eps", "2"}, {"--no-discontinuities", ""}}},
        Subject{"ProbeByPaths", "probe SCENE PROFILE --at 0.2,0,0.5 ", {{"--max-error", "0.1"}}},
        Subject{"ProbeByFaces",
                "probe SCENE PROFILE --at 0.2,0,0.5 --solver hierarchical ",
                {{"--eps", "2"}, {"--no-discontinuities", ""}}},
        Subject{"ProbeABake", "probe SCENE PROFILE --at 0.2,0,0.5 --from BAKE ", {}},
        Subject{"Lux", "lux SCENE PROFILE --from BAKE ", {{"--samples", "32"}}},
        Subject{"Info", "info SCENE", {}}, Subject{"Doctor", "doctor", {}},
        Subject{"Compare", "compare BAKE OTHERBAKE", {}}, Subject{"Merge", "merge PART -o OUT", {}},
        Subject{"FactorsByClosedForms", "factors SCENE -o OUT.csv", {}},
        Subject{"FactorsByRays", "factors SCENE -o OUT.csv --method rays ", {{"--samples", "64"}}},
        Subject{"Relight",
                "relight SCENE -o OUT.lxr ",
                {{"--patches", "40"}, {"--rays", "64"}, {"--resolution", "8"}}},
        Subject{"Play", "relight --play LXR --script SCRIPT -o OUT ", {}}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace luxel::testing_support
