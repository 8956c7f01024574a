// Bakes that are killed, stopped or run out of disk, and go on: docs/method/checkpoints.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "luxel/base/random.h"
#include "tests/command.h"
#include "tests/running.h"

namespace luxel::testing_support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kCornellBox = scene_file("cornell-box.glb");
/// Parts are kept nearly from the start on.
const std::string kKeep = " --checkpoint 0.01";

/// A bake of a second or two, unless other options say otherwise.
std::string bake(const fs::path& folder, const std::string& more = "",
                 const std::string& scene = kCornellBox) {
  std::string command = "bake " + scene + " -o " + folder.string();
  for (const std::string option : {" --resolution 128", " --samples 768", " --direct-samples 256"})
    if (more.find(option.substr(0, option.rfind(' ') + 1)) == std::string::npos) command += option;
  return command + more;
}

nlohmann::json report_in(const fs::path& folder) {
  return nlohmann::json::parse(slurp(folder / "bake.json"));
}

/// The lightmap of a bake that nobody interrupted.
std::string undisturbed(const std::string& more = "") {
  const ScratchFolder s;
  const CommandResult done = luxel(bake(s.path / "b", more + " --checkpoint 0"));
  EXPECT_EQ(done.code, 0) << done.err;
  return slurp(s.path / "b/lightmap.exr");
}

/// Starts the command, and kills it when `ready` says so. False when it ended before.
bool kill_when(const std::string& arguments, const std::function<bool(double)>& ready,
               int signal = SIGKILL) {
  Running command(arguments);
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  while (!ready(seconds())) {
    if (command.ended()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return command.end_with(signal);
}

/// A bake killed when its checkpoint has so many bytes.
void leave_checkpoint(const fs::path& folder, uint64_t bytes = 400'000,
                      const std::string& more = "") {
  std::error_code none;
  const bool killed = kill_when(bake(folder, kKeep + more), [&](double) {
    const uint64_t size = fs::file_size(folder / "checkpoint.luxel", none);
    return !none && size >= bytes;
  });
  ASSERT_TRUE(killed) << "the bake was over before its checkpoint had " << bytes << " bytes";
}

class Checkpoint : public ::testing::Test {
 protected:
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path / "new" / "b";
  const fs::path file_ = folder_ / "checkpoint.luxel";
};
using CheckpointSlow = Checkpoint;

// At any moment, from the start of the process to after its end: each time the bake is killed again
// and again until one comes through.
void kill_at_random_moments(const fs::path& scratch, int most_kills) {
  const std::string expected = undisturbed();
  RandomStream random{7};
  int kills = 0, found = 0;
  for (int run = 0; kills < most_kills; ++run) {
    const fs::path folder = scratch / std::to_string(run);
    for (double longest_s = 1.5;; longest_s *= 1.2) {
      const double moment = longest_s * double(random.next());
      const std::string resume = fs::exists(folder / "checkpoint.luxel") ? " --resume" : "";
      if (!kill_when(bake(folder, kKeep + resume), [&](double s) { return s >= moment; })) break;
      ++kills;
    }
    const nlohmann::json report = report_in(folder);
    found += report["checkpoint"]["parts_found"].get<int>() > 0;
    ASSERT_EQ(slurp(folder / "lightmap.exr"), expected) << "after kill " << kills;
    for (const char* name : {"lightmap.exr", "baked.glb", "preview.png", "bake.json"})
      EXPECT_TRUE(fs::exists(folder / name)) << name;
    EXPECT_FALSE(fs::exists(folder / "checkpoint.luxel"));
  }
  EXPECT_GT(found, 0) << "no bake went on with anything: the moments are badly chosen";
}

TEST_F(CheckpointSlow, KilledAtRandomMomentsEndsWithTheSameBits) {
  kill_at_random_moments(scratch_.path, 8);
}
TEST_F(CheckpointSlow, KilledAtTwentyRandomMomentsEndsWithTheSameBits) {
  kill_at_random_moments(scratch_.path, 20);
}

// Threads, tiles and kills: one lightmap.
TEST_F(CheckpointSlow, TheSameAnswerForAnyThreadsMemoryAndInterruption) {
  const std::string expected = undisturbed(" --threads 1");
  // The smallest that works, and a bit: nearly all hits go to the file.
  const CommandResult small = luxel(bake(scratch_.path / "s", " --max-memory 1M"));
  const size_t at = small.err.find("smallest that works is ");
  ASSERT_NE(at, std::string::npos) << small.err;
  const int smallest = std::atoi(small.err.c_str() + at + 23);
  for (const int threads : {1, 2, 3, 16})
    for (const std::string& memory :
         {std::string(), " --max-memory " + std::to_string(smallest + 8) + "M"})
      for (const bool interrupted : {false, true}) {
        const std::string how = " --threads " + std::to_string(threads) + memory;
        const fs::path folder = scratch_.path / "b";
        fs::remove_all(folder);
        // Another number of threads and another memory go on with it.
        if (interrupted) leave_checkpoint(folder, 5'000'000, " --threads 2");
        const CommandResult done =
            luxel(bake(folder, kKeep + how + (interrupted ? " --resume" : "")));
        ASSERT_EQ(done.code, 0) << how << done.err;
        EXPECT_EQ(slurp(folder / "lightmap.exr"), expected) << how << interrupted;
        const nlohmann::json report = report_in(folder);
        EXPECT_EQ(report["checkpoint"]["parts_found"].get<int>() > 0, interrupted) << how;
        EXPECT_EQ(report["scratch_bytes"].get<uint64_t>() > 0, !memory.empty()) << how;
      }
}

TEST_F(CheckpointSlow, WithAnErrorAskedForGoesThroughTheSameRounds) {
  const std::string more = " --max-error 0.02";
  const std::string expected = undisturbed(more);
  leave_checkpoint(folder_, 20'000'000, more);
  ASSERT_EQ(luxel(bake(folder_, more + " --resume")).code, 0);
  EXPECT_EQ(slurp(folder_ / "lightmap.exr"), expected);
}

TEST_F(Checkpoint, OfAShortBakeIsNeverThere) {
  const CommandResult done = luxel(bake(folder_));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(files_in(folder_), kBakeFiles);
  EXPECT_EQ(report_in(folder_)["checkpoint"],
            (nlohmann::json{{"resumed", false}, {"parts_found", 0}, {"parts_kept", 0}}));
}

TEST_F(Checkpoint, AStoppedBakeSaysHowItGoesOnAndLeavesNothingElse) {
  std::string err;
  std::error_code none;
  {
    Running command(bake(folder_, kKeep + " --resolution 1024 --quiet"));
    while (!command.ended() && !fs::exists(file_, none))
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    command.end_with(SIGINT);
    err = command.err();
  }
  EXPECT_EQ(err, "luxel: stopped by the user; --resume continues from " + file_.string() + "\n");
  EXPECT_EQ(files_in(folder_), std::set<std::string>{"checkpoint.luxel"});
}

TEST_F(Checkpoint, IsLeftAloneUntilTheBakeThatStartsOverKeepsItsOwn) {
  leave_checkpoint(folder_);
  const std::string before = slurp(file_);
  // Any moment will do that comes before its first checkpoint, half a minute after its start.
  ASSERT_TRUE(kill_when(bake(folder_), [](double s) { return s > 0.3; }));
  EXPECT_EQ(slurp(file_), before);
  const CommandResult done = luxel(bake(folder_));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr(file_.string() + " belongs to an unfinished bake; this bake "
                                                   "starts from the beginning"));
  EXPECT_EQ(report_in(folder_)["checkpoint"]["parts_found"], 0);
  EXPECT_EQ(files_in(folder_), kBakeFiles);
}

TEST_F(Checkpoint, ThatIsNotThereIsSaidToBe) {
  const CommandResult done = luxel(bake(folder_, " --resume"));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("there is no " + file_.string() + " to resume from"));
}

/// The bake is refused, and the checkpoint stays as it is.
void expect_refused(const fs::path& folder, const CommandResult& result,
                    const std::string& sentence) {
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr(sentence));
  EXPECT_EQ(files_in(folder), std::set<std::string>{"checkpoint.luxel"});
}

TEST_F(Checkpoint, OfOtherSettingsIsRefusedByName) {
  leave_checkpoint(folder_);
  const std::string is = file_.string() + " belongs to another bake: ";
  const auto refused = [&](const std::string& more, const std::string& difference,
                           const std::string& scene = kCornellBox) {
    expect_refused(folder_, luxel(bake(folder_, " --resume" + more, scene)), is + difference);
  };
  refused(" --samples 513", "samples 768 there, 513 here; leave --resume out");
  refused(" --seed 2", "seed 1 there, 2 here");
  refused(" --bounces 3", "bounces \"inf\" there, 3 here");
  refused(" --sun 0,45,100", "sun nothing there, [0.0,45.0,100.0] here");
  refused(" --background 0,0,1", "background nothing there, [0.0,0.0,1.0] here");
  // Neither changes a bit of the light.
  ASSERT_EQ(luxel(bake(folder_, " --resume --threads 1 --html")).code, 0);
}

TEST_F(Checkpoint, OfAnotherSceneIsRefusedByWhatHasChanged) {
  // A triangle and a lamp in text, so that they can be edited.
  const std::string obj = "o floor\nv 0 0 0\nv 4 0 0\nv 0 0 -4\nv 4 0 -4\nf 1 2 4 3\n";
  const std::string scene = scratch_.write("room.obj", obj).string();
  const std::string more = kKeep + " --samples 4096 --resolution 256";
  ASSERT_TRUE(kill_when(bake(folder_, more, scene), [&](double) { return fs::exists(file_); }));
  std::string edited = obj;
  edited.replace(edited.find("v 4 0 0"), 7, "v 5 0 0");
  scratch_.write("room.obj", edited);
  expect_refused(folder_, luxel(bake(folder_, more + " --resume", scene)),
                 "belongs to another bake: mesh 'floor' has changed");
  scratch_.write("room.obj", obj + "o more\nv 0 1 0\nv 4 1 0\nv 0 1 -4\nf 5 6 7\n");
  expect_refused(folder_, luxel(bake(folder_, more + " --resume", scene)),
                 "belongs to another bake: 1 of kind mesh there, 2 here");
}

TEST_F(Checkpoint, ThatIsDamagedIsRefused) {
  leave_checkpoint(folder_);
  std::string bytes = slurp(file_);
  const auto damage = [&](size_t at) {
    std::string damaged = bytes;
    damaged[at] = char(damaged[at] ^ 4);
    std::ofstream(file_, std::ios::binary) << damaged;
    expect_refused(folder_, luxel(bake(folder_, " --resume")),
                   file_.string() + " is damaged at byte ");
  };
  damage(3), damage(20), damage(100), damage(100'000);
  std::ofstream(file_, std::ios::binary) << "";
  expect_refused(folder_, luxel(bake(folder_, " --resume")), "is damaged at byte 0");
  // A cut is what a kill leaves.
  bytes.resize(bytes.size() / 2);
  std::ofstream(file_, std::ios::binary) << bytes;
  ASSERT_EQ(luxel(bake(folder_, " --resume")).code, 0);
  EXPECT_GT(report_in(folder_)["checkpoint"]["parts_found"], 0);
}

// A limit on the size of files stands for the disk: the results are smaller than the checkpoint.
TEST_F(Checkpoint, WithoutRoomOnTheDiskIsGivenUp) {
  const std::string expected = undisturbed();
  const CommandResult done = luxel(bake(folder_, kKeep), "ulimit -f 4000; exec");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err,
              HasSubstr("warning: cannot write " + file_.string() + ": File too large; "));
  EXPECT_EQ(slurp(folder_ / "lightmap.exr"), expected);
  EXPECT_EQ(files_in(folder_), kBakeFiles);
  EXPECT_THAT(report_in(folder_)["warnings"].dump(), HasSubstr("parts finished from now on"));
}

TEST_F(Checkpoint, TwoBakesInOneFolderAreRefused) {
  const std::string brief = " --resolution 32 --samples 4 --direct-samples 4";
  {
    Running first(bake(folder_, kKeep + " --resolution 1024"));
    // It holds the folder before it keeps anything.
    while (!first.ended() && !fs::exists(file_))
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const CommandResult second = luxel(bake(folder_));
    EXPECT_EQ(second.code, 1);
    EXPECT_THAT(second.err, HasSubstr("another bake is using " + folder_.string()));
    EXPECT_TRUE(fs::exists(folder_)) << "it belongs to the first";
    const CommandResult beside = luxel(bake(scratch_.path / "beside", brief));
    EXPECT_EQ(beside.code, 0) << beside.err;
    first.end_with(SIGKILL);
  }
  const CommandResult after = luxel(bake(folder_, brief));
  EXPECT_EQ(after.code, 0) << "the lock goes with its process: " << after.err;
}

TEST_F(Checkpoint, IsForSolversThatKeepParts) {
  for (const std::string solver : {"hemicube", "matrix", "hierarchical", "reference"})
    for (const std::string option : {"--resume", "--checkpoint 10"}) {
      const CommandResult refused = luxel("bake " + kCornellBox + " -o " + folder_.string() +
                                          " --solver " + solver + " " + option);
      EXPECT_EQ(refused.code, 1);
      EXPECT_THAT(refused.err, HasSubstr("--solver " + solver + " does not use --"));
      EXPECT_THAT(refused.err, HasSubstr("(it is for gather)"));
    }
  const CommandResult negative = luxel(bake(folder_, " --checkpoint=-1"));
  EXPECT_EQ(negative.code, 1);
  EXPECT_THAT(negative.err, HasSubstr("--checkpoint -1 is outside 0 to"));
  EXPECT_FALSE(fs::exists(folder_));
}

}  // namespace
}  // namespace luxel::testing_support
