// Ctrl-C and SIGTERM: the program ends within a second, with code 130, and leaves nothing.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

struct Stopped {
  int status = 0;             ///< as waitpid() gives it
  double seconds_to_end = 0;  ///< from the signal
  std::string err;
};

/// Starts `luxel arguments...`, waits, sends the signal, and waits for the end.
Stopped stop_after(double seconds, int signal, std::vector<std::string> arguments) {
  const ScratchFolder scratch;
  const std::string err = (scratch.path / "err").string();
  arguments.insert(arguments.begin(), LUXEL_BINARY);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const auto start = Clock::now();
  ::kill(child, signal);
  Stopped stopped;
  ::waitpid(child, &stopped.status, 0);
  stopped.seconds_to_end = std::chrono::duration<double>(Clock::now() - start).count();
  stopped.err = slurp(err);
  return stopped;
}

void expect_stopped_cleanly(double seconds, int signal, const std::string& scene,
                            const std::vector<std::string>& more = {}) {
  const ScratchFolder scratch;
  std::vector<std::string> arguments{
      "bake",         scene,  "-o",        (scratch.path / "new" / "baked").string(),
      "--resolution", "2048", "--samples", "4096"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Stopped stopped = stop_after(seconds, signal, arguments);
  const std::string what = scene + " after " + std::to_string(seconds) + " s: " + stopped.err;
  ASSERT_TRUE(WIFEXITED(stopped.status)) << what;
  EXPECT_EQ(WEXITSTATUS(stopped.status), 130) << what;
  // The program gives itself 0.8 s and ends then, whatever it does; the rest is for a machine whose
  // cores are busy with other tests, and for the sanitizers.
  EXPECT_LT(stopped.seconds_to_end, 2.5) << what;
  EXPECT_THAT(stopped.err, HasSubstr("luxel: stopped by the user\n"));
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path)) << what;
}

TEST(InterruptSlow, WhileRaysAreTraced) {
  for (const int signal : {SIGINT, SIGTERM})
    expect_stopped_cleanly(1, signal, scene_file("cornell-box.glb"));
}

// The hits go to a file then: it has to be gone too.
TEST(InterruptSlow, WhileHitsAreSpilled) {
  expect_stopped_cleanly(1.5, SIGINT, scene_file("cornell-box.glb"), {"--max-memory", "600M"});
}

TEST(InterruptSlow, WhileALargeSceneIsImportedAndLaidOut) {
  LUXEL_NEEDS_SHARED("scenes/zdm2/zdm2.glb");
  const std::string scene = (shared_folder() / "scenes/zdm2/zdm2.glb").string();
  for (const double seconds : {0.03, 0.3, 0.8, 1.6}) expect_stopped_cleanly(seconds, SIGINT, scene);
}

TEST(InterruptSlow, WhileViewFactorsAreComputed) {
  LUXEL_NEEDS_SHARED("scenes/zdm2/zdm2.glb");
  const ScratchFolder scratch;
  const std::string scene = (shared_folder() / "scenes/zdm2/zdm2.glb").string();
  for (const std::string method : {"analytic", "rays", "hemicube"}) {
    std::vector<std::string> arguments{"factors",  scene, "-o", (scratch.path / "f.csv").string(),
                                       "--method", method};
    if (method == "rays") arguments.insert(arguments.end(), {"--samples", "16777216"});
    if (method == "hemicube") arguments.insert(arguments.end(), {"--hemicube", "4096"});
    const Stopped stopped = stop_after(2, SIGINT, arguments);
    ASSERT_TRUE(WIFEXITED(stopped.status)) << method;
    EXPECT_EQ(WEXITSTATUS(stopped.status), 130) << method << stopped.err;
    EXPECT_LT(stopped.seconds_to_end, 2.5) << method;
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path)) << method;
  }
}

TEST(InterruptSlow, FilesOfAnEarlierBakeStay) {
  const ScratchFolder s;
  const std::string box = scene_file("cornell-box.glb"), output = (s.path / "b").string();
  ASSERT_EQ(luxel("bake " + box + " -o " + output + " --resolution 32 --samples 4").code, 0);
  const std::string before = slurp(s.path / "b/lightmap.exr");
  stop_after(0.5, SIGINT, {"bake", box, "-o", output, "--resolution", "2048"});
  EXPECT_EQ(slurp(s.path / "b/lightmap.exr"), before);
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
}

}  // namespace
}  // namespace luxel::testing_support
