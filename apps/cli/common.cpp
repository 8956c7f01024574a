#include <csignal>
#include <cstdio>
#include <thread>

#include <unistd.h>

#include "apps/cli/cli.h"

namespace luxel::cli {
namespace {

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::out_of_memory:
    case ErrorCode::out_of_disk:
    case ErrorCode::out_of_time:
      return kOutOfResource;
    case ErrorCode::cancelled:
      return kInterrupted;
    default:
      return kBadInput;
  }
}

std::string clock_text(double seconds) {
  const long s = long(seconds + 0.5);
  return s < 60 ? fmt::format("{} s", s) : fmt::format("{}:{:02} min", s / 60, s % 60);
}

/// Shows stages on stderr: one line that is rewritten on a terminal, else one line per stage.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

  void show(const Progress::Snapshot& now) {
    if (quiet_ || now.stage_index < 0) return;
    if (now.stage_index != last_.stage_index) end_stage();
    last_ = now;
    if (!terminal_) return;
    std::string line = now.stage;
    if (now.total > 0 && now.stage_seconds > 0) {
      const double share = double(now.done) / double(now.total);
      line += fmt::format("  {:3.0f} %", 100 * share);
      if (now.stage == "trace rays")
        line += fmt::format("  {:.1f} Mrays/s", double(now.done) * 1e-6 / now.stage_seconds);
      if (share > 0.02)
        line += "  " + clock_text(now.stage_seconds * (1 - share) / share) + " left";
    }
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
  }

  void end_stage() {
    if (quiet_ || last_.stage_index < 0) return;
    std::string line = fmt::format("{:<18}{:7.2f} s", last_.stage, last_.stage_seconds);
    if (last_.stage == "trace rays" && last_.stage_seconds > 0)
      line += fmt::format("   {:.1f} Mrays/s", double(last_.total) * 1e-6 / last_.stage_seconds);
    std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\033[K" : "", line.c_str());
    last_ = {};
  }

  void catch_up(const Progress& progress) {
    const auto stages = progress.stages();
    if (last_.stage_index >= 0 && size_t(last_.stage_index) < stages.size())
      last_.stage_seconds = stages[size_t(last_.stage_index)].seconds;
    shown_ = std::max(shown_, last_.stage_index + 1);
  }

 private:
  bool quiet_, terminal_;
  int shown_ = 0;
  Progress::Snapshot last_;
};

/// Waits for Ctrl-C at most a tenth of a second. True when it came.
bool stop_requested() {
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGINT);
  sigaddset(&stop, SIGTERM);
  const timespec patience{0, 100'000'000};
  return sigtimedwait(&stop, nullptr, &patience) > 0;
}

void watch(Progress& progress, const std::atomic<bool>& done, bool quiet) {
  using Clock = std::chrono::steady_clock;
  ProgressLine line(quiet);
  Clock::time_point asked{};
  while (!done) {
    if (stop_requested()) {
      if (asked == Clock::time_point{}) asked = Clock::now();
      progress.request_cancel();
    }
    line.show(progress.snapshot());
    // Reading a file cannot be asked to stop; writing may finish, so that all files are there.
    const bool late =
        asked != Clock::time_point{} && Clock::now() - asked > std::chrono::milliseconds(800);
    if (late && progress.snapshot().stage != "write files") {
      std::fputs("\nluxel: stopped by the user\n", stderr);
      ::_exit(kInterrupted);
    }
  }
  line.catch_up(progress);
  line.end_stage();
}

}  // namespace

void add_common(CLI::App& command, Common& common) {
  command.add_option("--threads", common.threads, "Threads to use; 0 = all cores")
      ->capture_default_str();
  command.add_flag("--quiet", common.quiet, "No progress, no warnings");
  command.add_flag("--json", common.json, "One JSON object on stdout, everything else on stderr");
}

void add_outside_light(CLI::App& command, OutsideText& text) {
  command.add_option("--background", text.background, "Radiance of the surroundings as r,g,b")
      ->type_name("R,G,B");
  command
      .add_option("--sun", text.sun,
                  "A sun: bearing (0 = -Z, 90 = +X), elevation, illuminance facing it")
      ->type_name("AZIMUTH_DEG,ELEVATION_DEG,LUX");
}

Result<pipeline::OutsideLight> parse_outside_light(const OutsideText& text) {
  pipeline::OutsideLight outside;
  if (!text.background.empty()) {
    LUXEL_TRY(outside.background, pipeline::parse_background(text.background));
  }
  if (!text.sun.empty()) {
    LUXEL_TRY(outside.sun, pipeline::parse_sun(text.sun));
  }
  return outside;
}

int report(const Error& error) {
  std::fprintf(stderr, "luxel: %s\n", error.message.c_str());
  return exit_code(error.code);
}

void print_warnings(const std::vector<std::string>& warnings, const Common& common) {
  if (common.quiet) return;
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

int run_with_progress(const Common& common, const std::function<int(Progress&)>& work) {
  Progress progress;
  std::atomic<bool> done{false};
  std::thread watcher([&] { watch(progress, done, common.quiet); });
  int code = kBadInput;
  try {
    code = work(progress);
  } catch (...) {
    done = true;
    watcher.join();
    throw;
  }
  progress.finish();
  done = true;
  watcher.join();
  return code;
}

}  // namespace luxel::cli
