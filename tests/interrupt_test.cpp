// Ctrl-C, SIGTERM and SIGHUP: the program ends within a second, with code 130, and leaves nothing.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <functional>
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

/// When to send the signal, looked at again and again: gets what the program has said so far. It
/// says by a line of JSON that a stage is done.
using Ready = std::function<bool(const std::string& err)>;

Ready after_stage(const std::string& stage) {
  return [name = "\"stage\":\"" + stage + "\""](const std::string& err) {
    std::istringstream lines(err);
    for (std::string line; std::getline(lines, line);)
      if (line.find("\"event\":\"stage\"") != line.npos && line.find(name) != line.npos)
        return true;
    return false;
  };
}

/// Starts `luxel arguments... --progress-json`, sends the signal when it is time, and waits for the
/// end.
Stopped stop_when(const Ready& ready, int signal, std::vector<std::string> arguments) {
  const ScratchFolder scratch;
  const std::string err = (scratch.path / "err").string();
  arguments.insert(arguments.begin(), LUXEL_BINARY);
  arguments.push_back("--progress-json");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  Stopped stopped;
  const auto said = [&] { return std::filesystem::exists(err) ? slurp(err) : std::string(); };
  while (!ready(said())) {
    // A program that ends by itself has not come to what the test waits for: its status says so.
    if (::waitpid(child, &stopped.status, WNOHANG) == child) return stopped.err = said(), stopped;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const auto start = Clock::now();
  ::kill(child, signal);
  ::waitpid(child, &stopped.status, 0);
  stopped.seconds_to_end = std::chrono::duration<double>(Clock::now() - start).count();
  stopped.err = said();
  return stopped;
}

void expect_stopped(const Stopped& stopped, const std::string& what) {
  ASSERT_TRUE(WIFEXITED(stopped.status)) << what << stopped.err;
  EXPECT_EQ(WEXITSTATUS(stopped.status), 130) << what << stopped.err;
  // The program gives itself 0.8 s and ends then, whatever it does; the rest is for a machine whose
  // cores are busy with other tests, and for the sanitizers.
  EXPECT_LT(stopped.seconds_to_end, 2.5) << what;
  EXPECT_THAT(stopped.err, HasSubstr("\"stopped by the user\"")) << what;
}

/// A bake that would take minutes and is stopped leaves nothing, not even the folder it made.
void expect_bake_stopped(const Ready& ready, int signal, const std::string& scene,
                         std::vector<std::string> options) {
  const ScratchFolder scratch;
  options.insert(options.begin(), {"bake", scene, "-o", (scratch.path / "new" / "baked").string()});
  expect_stopped(stop_when(ready, signal, options), scene);
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path)) << scene;
}

/// Direct light is known soon, and the rays take a minute.
const std::vector<std::string> kManyRays{"--resolution",     "256", "--samples", "16384",
                                         "--direct-samples", "4"};

// Supersampling is the last stage before them.
TEST(InterruptSlow, WhileRaysAreTraced) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    expect_bake_stopped(after_stage("supersample"), signal, scene_file("cornell-box.glb"),
                        kManyRays);
}

// The hits, 8 GB, go to a file then: it has to be gone too.
TEST(InterruptSlow, WhileHitsAreSpilled) {
  std::vector<std::string> options = kManyRays;
  options.insert(options.end(), {"--max-memory", "600M"});
  expect_bake_stopped(after_stage("supersample"), SIGINT, scene_file("cornell-box.glb"), options);
}

TEST(InterruptSlow, WhileALargeSceneIsImportedAndLaidOut) {
  LUXEL_NEEDS_SHARED("scenes/zdm2/zdm2.glb");
  const std::string scene = (shared_folder() / "scenes/zdm2/zdm2.glb").string();
  for (const char* stage : {"import", "charts", "packing", "build ray tracer"})
    expect_bake_stopped(after_stage(stage), SIGINT, scene, {"--resolution", "2048"});
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
    const char* before = method == "analytic" ? "join polygons" : "build ray tracer";
    expect_stopped(stop_when(after_stage(before), SIGINT, arguments), method);
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path)) << method;
  }
}

TEST(InterruptSlow, FilesOfAnEarlierBakeStay) {
  const ScratchFolder s;
  const std::string box = scene_file("cornell-box.glb"), output = (s.path / "b").string();
  ASSERT_EQ(luxel("bake " + box + " -o " + output + " --resolution 32 --samples 4").code, 0);
  const std::string before = slurp(s.path / "b/lightmap.exr");
  expect_stopped(stop_when(after_stage("packing"), SIGINT,
                           {"bake", box, "-o", output, "--resolution", "2048"}),
                 box);
  EXPECT_EQ(slurp(s.path / "b/lightmap.exr"), before);
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
}

// A signal that is ignored when the program starts stays ignored, as SIGHUP under nohup.
TEST(Interrupt, NotBySignalsThatAreIgnored) {
  const ScratchFolder s;
  const std::string output = (s.path / "b").string();
  const CommandResult r = shell("trap '' HUP; " LUXEL_BINARY " bake " +
                                scene_file("cornell-box.glb") + " -o " + output +
                                " --resolution 64 --samples 64 & "
                                "until test -d " +
                                output + "; do sleep 0.01; done; kill -HUP $!; wait $!");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(output), kBakeFiles);
}

// Nobody reads what is said on the way.
TEST(Interrupt, NotByAClosedPipe) {
  const ScratchFolder s;
  shell(LUXEL_BINARY " bake " + scene_file("cornell-box.glb") + " -o " + (s.path / "b").string() +
        " --resolution 32 --samples 4 --progress-json 2>&1 | true");
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
}

// Files may not be larger than 4 KB: that is a full disk, and leaves no folder.
TEST(Interrupt, ByALimitOnTheSizeOfFiles) {
  const ScratchFolder s;
  const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") + " -o " +
                                    (s.path / "b").string() + " --resolution 32 --samples 4",
                                "ulimit -f 8;");
  EXPECT_EQ(r.code, 3) << r.err;
  EXPECT_THAT(r.err, HasSubstr("File too large"));
  EXPECT_TRUE(std::filesystem::is_empty(s.path));
}

}  // namespace
}  // namespace luxel::testing_support
