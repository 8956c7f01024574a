// Bakes of processes that mpirun starts together: docs/guide/clusters.md.
#include <gmock/gmock.h>
#include <signal.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "luxel/base/record_file.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// mpirun as root, with more processes than cores. Open MPI keeps memory at its end.
std::string mpirun(int processes) {
  return fmt::format(
      "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
      "OMPI_MCA_rmaps_base_oversubscribe=1 ASAN_OPTIONS=detect_leaks=0 "
      "timeout 200 mpirun -n {}",
      processes);
}

class BakesOfATeam : public ::testing::Test {
 protected:
  void SetUp() override {
    if (shell("command -v mpirun").code != 0 ||
        luxel("--version").out.find("Open MPI") == std::string::npos)
      GTEST_SKIP() << "there is no Open MPI here, or luxel was built without it";
    ::unsetenv("OMPI_COMM_WORLD_SIZE");
  }

  std::string bake(const std::string& more) const {
    return "bake " + more + " -o " + folder_.string();
  }
  /// Bakes with so many processes, all of which work.
  CommandResult together(int processes, const std::string& more) const {
    return luxel(bake(more) + fmt::format(" --processes-per-node {}", processes),
                 mpirun(processes));
  }
  std::string done_together(int processes, const std::string& more) const {
    fs::remove_all(folder_);
    const CommandResult r = together(processes, more);
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_THAT(r.err, HasSubstr(fmt::format("{} processes on 1 node work together", processes)));
    return results_in(folder_);
  }
  std::string alone(const std::string& more) const {
    const fs::path folder = scratch_.path / "alone";
    fs::remove_all(folder);
    const CommandResult r = luxel("bake " + more + " -o " + folder.string());
    EXPECT_EQ(r.code, 0) << r.err;
    return results_in(folder);
  }
  /// Sends a signal to the process of a rank whose bake this test has started. False: there is
  /// none.
  bool signal_rank(int rank, int signal) const;

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path / "baked";
};
using BakesOfATeamSlow = BakesOfATeam;

bool BakesOfATeam::signal_rank(int rank, int signal) const {
  const std::string own_rank = fmt::format("OMPI_COMM_WORLD_RANK={}", rank) + '\0';
  std::error_code error;  // processes end while they are listed
  for (fs::directory_iterator at("/proc", error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    const fs::directory_entry& entry = *at;
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (slurp(entry.path() / "comm") != "luxel\n") continue;
    if (slurp(entry.path() / "cmdline").find(folder_.string()) == std::string::npos) continue;
    if (slurp(entry.path() / "environ").find(own_rank) == std::string::npos) continue;
    return ::kill(std::stoi(name), signal) == 0;
  }
  return false;
}

const std::string kKinds[] = {
    scene_file("cornell-box.glb") + " --resolution 96 --samples 64",
    scene_file("office.glb") + " --resolution 96 --max-error 0.02 --error-measure rms",
    scene_file("foliage.glb") + " --resolution 64 --samples 64 --layers per-light"};

// Messages between processes; that the members of a team have the same bits for many more cases is
// what GatherOfATeam says.
TEST_F(BakesOfATeam, HaveTheBitsOfOneProcess) {
  for (const auto& [processes, more] : {std::pair{2, kKinds[1]}, {8, kKinds[2]}})
    EXPECT_EQ(done_together(processes, more), alone(more)) << processes << ": " << more;
}

TEST_F(BakesOfATeamSlow, HaveTheBitsOfOneProcessForAnyNumber) {
  for (const std::string& more : kKinds) {
    const std::string expected = alone(more);
    for (const int processes : {2, 3, 8})
      EXPECT_EQ(done_together(processes, more), expected) << processes << ": " << more;
  }
}

// Other solvers and commands: paths, hemicubes, patches, view factors.
TEST_F(BakesOfATeam, HaveTheBitsOfOneProcessByOtherSolvers) {
  const std::string office = scene_file("office.glb") + " --resolution 48 --solver ";
  for (const std::string& more :
       {office + "reference --samples 16", office + "hemicube --max-elements 1500 --hemicube 16",
        office + "matrix --patches 500 --rays 256"})
    EXPECT_EQ(done_together(2, more), alone(more)) << more;
}

TEST_F(BakesOfATeam, HaveTheBitsOfOneProcessInTables) {
  const std::string box = scene_file("cornell-box.glb");
  const auto result = [&](const std::string& command, const std::string& before) {
    const fs::path file = scratch_.path / "result.lxr";
    const CommandResult r = luxel(command + " -o " + file.string(), before);
    EXPECT_EQ(r.code, 0) << r.err;
    return slurp(file);
  };
  for (const std::string& command :
       {"factors " + box, "factors " + box + " --method rays --samples 4096",
        "factors " + box + " --method hemicube --samples 4",
        "relight " + box + " --patches 300 --rays 256 --resolution 32"})
    EXPECT_EQ(result(command + " --processes-per-node 3", mpirun(3)), result(command, ""))
        << command;
}

// By default one process of a node works, with the cores of all. One of them speaks.
TEST_F(BakesOfATeam, LendCoresToTheOneOfTheirNodeThatWorks) {
  const std::string more = scene_file("cornell-box.glb") + " --resolution 64 --samples 16";
  const CommandResult r = luxel(bake(more + " --json"), mpirun(3));
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("3 processes on 1 node: 1 works, the others lend their cores"));
  EXPECT_EQ(nlohmann::json::parse(r.out)["settings"]["samples"], 16);
  EXPECT_EQ(results_in(folder_), alone(more));
}

TEST_F(BakesOfATeam, AreRefusedWithOneSentence) {
  const std::string box = scene_file("cornell-box.glb") + " --resolution 32 --samples 4";
  const auto error = [&](const CommandResult& r) {
    EXPECT_EQ(r.code, 1) << r.err;
    EXPECT_FALSE(fs::exists(folder_));
    EXPECT_EQ(r.err.find("luxel: "), r.err.rfind("luxel: ")) << r.err;
    return r.err;
  };
  for (const std::string other : {"--keep", "--part 1/2"})
    EXPECT_THAT(error(together(2, box + " " + other)),
                HasSubstr(other + " needs a single process"));
  EXPECT_THAT(error(together(2, scene_file("cornell-box.glb") + " --solver hierarchical")),
              HasSubstr("--solver hierarchical needs a single process"));
  const std::string per_node = " --processes-per-node 2";
  EXPECT_THAT(
      error(shell(mpirun(1) + " " LUXEL_BINARY " " + bake(box) + per_node + " : -n 1 " +
                  LUXEL_BINARY " " + bake(box) + " --bounces 2" + per_node)),
      HasSubstr("process 1 (there) has other settings than process 0 (here): bounces 2 there"));
  // A file that one node lacks.
  fs::create_directory(scratch_.path / "there"), fs::create_directory(scratch_.path / "not");
  fs::copy_file(scene_file("cornell-box.glb"), scratch_.path / "there" / "box.glb");
  const auto in = [&](const std::string& folder) {
    return fmt::format("-n 1 --wdir {} " LUXEL_BINARY " bake box.glb -o {} {}",
                       (scratch_.path / folder).string(), folder_.string(), per_node);
  };
  const std::string command = mpirun(1);
  EXPECT_THAT(
      error(shell(command.substr(0, command.rfind("-n")) + in("there") + " : " + in("not"))),
      HasSubstr("process 1 of 2 ("));
}

// A limit on the size of files stands for the disk of one of two nodes.
TEST_F(BakesOfATeam, GoOnWithoutTheCheckpointOfAFullDisk) {
  const std::string more = scene_file("office.glb") + " --resolution 128 --samples 1024";
  const std::string each = bake(more + " --checkpoint 0.01 --processes-per-node 2 --max-memory 2G");
  const CommandResult r =
      shell(mpirun(1) + " " LUXEL_BINARY " " + each +
            " : -n 1 sh -c 'ulimit -f 100; exec " LUXEL_BINARY " " + each + "'");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("warning: process 1: cannot write " +
                               (folder_ / "checkpoint-1.luxel").string() + ": File too large; "));
  EXPECT_EQ(results_in(folder_), alone(more));
}

TEST_F(BakesOfATeamSlow, SayWhichProcessHasNoRoomForItsHits) {
  const std::string more = scene_file("office.glb") + " --resolution 128 --samples 2048";
  const std::string refused = together(2, more + " --max-memory 1M").err;
  const size_t at = refused.find("that works is ");
  ASSERT_NE(at, std::string::npos) << refused;
  // A little more than the least, which the processes need not have in common: most of the 100 MB
  // of each one's hits go to the disk.
  const int least_mb = std::stoi(refused.substr(at + 14));
  const std::string each =
      bake(more + fmt::format(" --processes-per-node 2 --max-memory {}M", least_mb + 20));
  const CommandResult r =
      shell(mpirun(1) + " " LUXEL_BINARY " " + each +
            " : -n 1 sh -c 'ulimit -f 100; exec " LUXEL_BINARY " " + each + "'");
  EXPECT_NE(r.code, 0);
  EXPECT_THAT(r.err, HasSubstr("process 1 of 2 ("));
  EXPECT_THAT(r.err, HasSubstr("cannot write temporary data to "));
}

// One process has a tenth of its time: it makes less, and nothing else changes.
TEST_F(BakesOfATeamSlow, WaitForAProcessThatIsTenTimesSlower) {
  const std::string more = scene_file("office.glb") + " --resolution 96 --samples 128";
  const std::string expected = alone(more);
  std::atomic<bool> is_over = false;
  int stops = 0;
  std::thread brake([&] {
    while (!is_over) {
      stops += signal_rank(1, SIGSTOP);
      std::this_thread::sleep_for(std::chrono::milliseconds(90));
      signal_rank(1, SIGCONT);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  const std::string found = done_together(2, more);
  is_over = true;
  brake.join();
  EXPECT_EQ(found, expected);
  EXPECT_GT(stops, 10);
}

/// Bakes that are killed, process by process, until one comes through.
class KilledBakes : public BakesOfATeam {
 protected:
  /// A bake of so many processes, one of which is killed after a while. Returns whether it was.
  bool kill_one(int processes, int rank, double after_s) const {
    const std::string resume = fs::exists(folder_) ? " --resume" : "";
    CommandResult r;
    std::thread bake([&] { r = together(processes, more_ + resume); });
    std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
    const bool killed = signal_rank(rank, SIGKILL);
    bake.join();
    if (!killed) {
      EXPECT_EQ(r.code, 0) << r.err;
    }
    return killed && r.code != 0;
  }
  /// Parts that all checkpoints have.
  size_t parts_kept() const {
    std::set<RecordKey> keys;
    for (const std::string& name : files_in(folder_)) {
      const auto file = RecordFile::open_to_read(folder_ / name);
      if (!file) continue;
      for (const RecordKey& key : file->keys()) keys.insert(key);
    }
    return keys.size();
  }
  /// Any number of processes goes on from all of it: one, too.
  nlohmann::json ended_by_one() const {
    const CommandResult r = luxel(bake(more_ + " --resume --json"));
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out)["checkpoint"];
  }

  const std::string more_ =
      scene_file("office.glb") + " --resolution 192 --samples 512 --checkpoint 0.05";
};

TEST_F(KilledBakes, LoseNothingThatIsFinished) {
  int kills = 0;
  for (const auto& [processes, rank, after_s] : {std::tuple{3, 2, 1.6}, {2, 0, 1.9}})
    kills += kill_one(processes, rank, after_s);
  ASSERT_GT(kills, 0);
  if (!fs::exists(folder_))
    GTEST_SKIP() << "this machine is too slow, or too fast, for the moments";
  const size_t kept = parts_kept();
  const nlohmann::json checkpoint = ended_by_one();
  EXPECT_EQ(checkpoint["parts_found"], kept);
  EXPECT_EQ(files_in(folder_), kBakeFiles);
  EXPECT_EQ(results_in(folder_), alone(more_));
}

using KilledBakesSlow = KilledBakes;

// Forty processes at random, of two to four.
TEST_F(KilledBakesSlow, LoseNothingInFortyKills) {
  std::mt19937 random{31};
  const auto up_to = [&](int most) { return int(random() % unsigned(most)); };
  const std::string expected = alone(more_);
  int kills = 0, ends = 0;
  size_t kept = 0;
  for (int run = 0; kills < 40 && run < 200; ++run) {
    const int processes = 2 + up_to(3);
    const double after_s = 0.5 + 0.01 * up_to(250);
    const bool killed = kill_one(processes, up_to(processes), after_s);
    kills += killed;
    // One that is killed when all is written has come to its end, too, though checkpoints may stay.
    if (!killed || fs::exists(folder_ / "bake.json")) {
      for (const std::string& name : files_in(folder_))
        if (name.ends_with(".luxel")) fs::remove(folder_ / name);
      EXPECT_EQ(results_in(folder_), expected) << "after kill " << kills;
      fs::remove_all(folder_);
      ++ends, kept = 0;
      continue;
    }
    const size_t now = fs::exists(folder_) ? parts_kept() : 0;
    EXPECT_GE(now, kept) << "after kill " << kills;
    kept = now;
  }
  EXPECT_EQ(kills, 40);
  if (fs::exists(folder_)) {
    EXPECT_EQ(ended_by_one()["parts_found"], kept);
    EXPECT_EQ(results_in(folder_), expected);
  }
  std::printf("40 processes killed; %d bakes came to their end in between\n", ends);
}

}  // namespace
}  // namespace luxel::testing_support
