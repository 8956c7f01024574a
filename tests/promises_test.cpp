// Promises of every command to its user, before and after the work: output files are tried out
// first, senseless numbers are refused, and results that nobody got are an error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The scene is missing, too, and is not what is said: outputs are looked at first.
TEST(OutputFiles, AreTriedOutBeforeTheWork) {
  const ScratchFolder s;
  const std::string lost = (s.path / "lost").string(), scene = (s.path / "no.glb").string();
  const std::pair<std::string, std::string> commands[] = {
      {"relight " + scene, "a.lxr"},
      {"factors " + scene, "a.csv"},
      {"render " + scene + " --technique path", "a.png"},
      {"probe " + scene + " --at 0,1,0 --solver hierarchical", "a.png"},
      {"lux " + scene + " --from " + lost, "a.csv"}};
  for (const auto& [command, file] : commands) {
    const CommandResult missing = luxel(command + " -o " + lost + "/" + file);
    EXPECT_EQ(missing.code, 1) << command;
    EXPECT_THAT(missing.err, AllOf(HasSubstr(lost + "/" + file), HasSubstr("there is no folder")))
        << command;
    const CommandResult locked = luxel(command + " -o /proc/" + file);
    EXPECT_EQ(locked.code, 1) << command;
    EXPECT_THAT(locked.err, HasSubstr("cannot write /proc/")) << command;
    std::filesystem::create_directory(s.path / file);
    const CommandResult folder = luxel(command + " -o " + (s.path / file).string());
    EXPECT_EQ(folder.code, 1) << command;
    EXPECT_THAT(folder.err, HasSubstr(file + " is a folder")) << command;
  }
  const CommandResult report = luxel("compare a.png b.png --report /proc/luxel");
  EXPECT_EQ(report.code, 1);
  EXPECT_THAT(report.err, HasSubstr("cannot make the output folder /proc/luxel"));
  EXPECT_EQ(files_in(s.path), (std::set<std::string>{"a.lxr", "a.csv", "a.png"}));
}

TEST(OutputFiles, DoNotReplaceADevice) {
  const ScratchFolder s;
  const std::string pipe = (s.path / "pipe.csv").string();
  ASSERT_EQ(std::system(("mkfifo " + pipe).c_str()), 0);
  const CommandResult r = luxel("factors " + scene_file("furnace-box.glb") + " -o " + pipe);
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("is a device or a pipe"));
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

struct WrongNumber {
  const char *arguments, *words;
  int code = 2;
};

TEST(Numbers, ThatMakeNoSenseAreRefused) {
  const ScratchFolder s;
  const std::string scene = scene_file("furnace-box.glb");
  const auto output = [&](const char* name) { return " -o " + (s.path / name).string(); };
  const std::pair<std::string, std::vector<WrongNumber>> commands[] = {
      {"bake " + scene + output("baked"),
       {{"--probes 0", "--probes 0 is not a spacing", 1},
        {"--texels-per-metre 0", "--texels-per-metre 0 is not a density", 1},
        {"--solver hemicube --element-size 0", "--element-size 0 is not a length", 1},
        {"--seed -1", "--seed -1", 1}}},
      {"relight " + scene + output("a.lxr"),
       {{"--seed -1", "--seed -1 is below 0", 1},
        {"--texels-per-metre 0", "--texels-per-metre 0 is not a density", 1},
        {"--texels-per-metre nan", "--texels-per-metre nan is not a density", 1},
        {"--threads -1", "--threads: -1 is not a whole number from 0 to 1024"}}},
      {"probe " + scene + " --at 0,0.5,0",
       {{"--seed -1", "--seed: -1"},
        {"--seed 1.5", "--seed: 1.5"},
        {"--threads -1", "--threads: -1"},
        {"--max-error 0", "--max-error 0 is not above 0", 1}}},
      {"factors " + scene + output("a.csv"),
       {{"--seed -1", "--seed: -1"}, {"--threads 99999", "--threads: 99999"}}},
      {"render " + scene + output("a.png") + " --technique path",
       {{"--seed -1", "--seed: -1"}, {"--threads -1", "--threads: -1"}}},
      {"lux " + scene + " --from baked",
       {{"--seed -1", "--seed: -1"}, {"--floor nan", "--floor nan is not a height", 1}}},
      {"info " + scene, {{"--threads -1", "--threads: -1"}}},
      {"compare a.png b.png", {{"--threads -1", "--threads: -1"}}},
      {"bench stated", {{"--first-seed -1", "--first-seed: -1"}}}};
  for (const auto& [command, numbers] : commands)
    for (const WrongNumber& number : numbers) {
      const CommandResult r = luxel(command + " " + number.arguments);
      EXPECT_EQ(r.code, number.code) << command << " " << number.arguments << "\n" << r.err;
      EXPECT_THAT(r.err, HasSubstr(number.words)) << command;
    }
  EXPECT_TRUE(files_in(s.path).empty());
}

/// The command with its results into `stream`. --version asks for devices.
CommandResult with_output(const std::string& arguments, const std::string& stream) {
  const ScratchFolder s;
  const std::string err = (s.path / "err").string();
  CommandResult r = luxel(arguments + " >" + stream + " 2>" + err + " #", kNoLeakSearch);
  r.err = slurp(err);
  return r;
}

TEST(Results, ThatNobodyGotAreAnError) {
  const std::string scene = scene_file("furnace-box.glb");
  const std::string probe = "probe " + scene + " --at 0,0.1,0.1 --max-error 0.5";
  for (const std::string& arguments :
       {"info " + scene, "info " + scene + " --json", probe, probe + " --json",
        std::string("--help"), std::string("bake --help"), std::string("--version")}) {
    const CommandResult full = with_output(arguments, "/dev/full");
    EXPECT_EQ(full.code, 3) << arguments;
    EXPECT_THAT(full.err, HasSubstr("cannot write the results to standard output: No space left"))
        << arguments;
    const CommandResult closed = with_output(arguments, "&-");
    EXPECT_EQ(closed.code, 1) << arguments;
    EXPECT_THAT(closed.err, HasSubstr("cannot write the results to standard output")) << arguments;
  }
  EXPECT_EQ(luxel("info " + scene).code, 0);
}

// The table would get the number of standard output, and what is printed would go into it.
TEST(Results, DoNotGoIntoAFileWhereStandardOutputIsClosed) {
  const ScratchFolder s;
  const std::string factors = "factors " + scene_file("furnace-box.glb") + " -o ";
  ASSERT_EQ(luxel(factors + (s.path / "open.csv").string()).code, 0);
  EXPECT_EQ(with_output(factors + (s.path / "closed.csv").string(), "&-").code, 1);
  EXPECT_EQ(slurp(s.path / "closed.csv"), slurp(s.path / "open.csv"));
}

/// A .b3d file of nodes in nodes, a format that luxel does not look over before Assimp.
std::string deep_b3d(uint32_t depth) {
  const auto word = [](uint32_t value) {
    char bytes[4];
    std::memcpy(bytes, &value, 4);
    return std::string(bytes, 4);
  };
  const std::string node = "a" + std::string(41, '\0');
  std::string file = "BB3D" + word(4 + depth * 50) + word(1);
  for (uint32_t i = 0; i < depth; ++i) file += "NODE" + word((depth - i) * 50 - 8) + node;
  return file;
}

TEST(StackOverflow, IsASentence) {
  const ScratchFolder s;
  const std::string file = s.write("deep.b3d", deep_b3d(100000)).string();
  const CommandResult r =
      luxel("bake --any-format " + file + " --json -o " + (s.path / "b").string());
  EXPECT_EQ(r.code, 1);
  EXPECT_EQ(files_in(s.path), std::set<std::string>{"deep.b3d"});
  EXPECT_THAT(r.err,
              HasSubstr("deep.b3d: the stack is full; the parts of a file are nested too deeply"));
  EXPECT_THAT(r.out, HasSubstr("\"exit_code\": 1"));
}

}  // namespace
}  // namespace luxel::testing_support
