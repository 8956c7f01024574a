// Work whose progress is shown on stderr while it runs, and that Ctrl-C stops.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <thread>
#include <utility>

#include <unistd.h>

#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "apps/cli/terminal.h"
#include "luxel/base/clock.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/stop_signals.h"

namespace luxel::cli {
namespace {

constexpr const char* kStopped = "stopped by the user";

std::string stopped_text(const Progress& progress) {
  const std::string way_on = progress.way_on();
  return way_on.empty() ? kStopped : fmt::format("{}; {}", kStopped, way_on);
}

/// Lines that say how far the work is, where they stay: at most one in so many seconds, and one per
/// so much of the work.
constexpr double kLineSeconds = 10, kLineShare = 0.1;

/// Shows the work on stderr: how far it is, one line that is rewritten on a terminal, and in the
/// end a line for each stage.
class ProgressLine {
 public:
  explicit ProgressLine(const Common& common)
      : quiet_(common.quiet), says_way_on_(common.in_team), terminal_(rewrites_lines()) {}

  void show(const Progress& progress) {
    const Progress::Snapshot now = progress.snapshot();
    print_notes(progress);
    if (quiet_ || now.stage_index < 0) return;
    say_way_on(progress);
    count_rays(now);
    if (!terminal_) return print_share(now);
    std::string line = share_text(now) + now.stage;
    if (now.stage == kRayStage && now.stage_seconds > 0)
      line += fmt::format("  {:.1f} Mrays/s",
                          double(now.done - now.skipped) * 1e-6 / now.stage_seconds);
    rewrite_line(line + left_text(now));
  }

  /// The work has ended: shows the stages it has finished. After an error the last one is not.
  void end(const Progress& progress, bool succeeded) {
    print_notes(progress);
    if (quiet_) return;
    clear_line();
    std::vector<Stage> stages = progress.stages();
    if (!succeeded && !stages.empty()) stages.pop_back();
    for (const Stage& stage : with_one_name_each(stages)) {
      std::string line = fmt::format("{:<18}{:7.2f} s", stage.name, stage.seconds);
      if (stage.name == kRayStage && rays_ + stage_rays_ > 0 && stage.seconds > 0)
        line +=
            fmt::format("   {:.1f} Mrays/s", double(rays_ + stage_rays_) * 1e-6 / stage.seconds);
      print_line(stderr, line);
    }
  }

 private:
  static constexpr const char* kRayStage = "trace rays";

  /// Stages that come again, as in rounds, are one, in the order in which they first came.
  static std::vector<Stage> with_one_name_each(std::span<const Stage> stages) {
    std::vector<Stage> out;
    for (const Stage& stage : stages) {
      const auto found = std::ranges::find(out, stage.name, &Stage::name);
      if (found == out.end())
        out.push_back(stage);
      else
        found->seconds += stage.seconds;
    }
    return out;
  }
  static std::string share_text(const Progress::Snapshot& now) {
    return now.share < 0 ? std::string() : fmt::format("{:3.0f} %  ", std::floor(100 * now.share));
  }
  static std::string left_text(const Progress::Snapshot& now) {
    if (now.seconds_left >= 0) return "  " + clock_text(now.seconds_left) + " left";
    // Work that was kept from before has taken no time.
    const double done = double(now.done - now.skipped), total = double(now.total - now.skipped);
    const double share = total > 0 ? done / total : 0;
    // Long work has an estimate early, too.
    const bool known = share > 0.02 || (share > 0 && now.stage_seconds > 3);
    return known
               ? "  " + clock_text(now.stage_seconds * (1 - share) / share) + " left in this stage"
               : std::string();
  }

  void print_share(const Progress::Snapshot& now) {
    if (now.share < next_share_ || seconds_since(printed_) < kLineSeconds) return;
    print_line(stderr, share_text(now) + now.stage + left_text(now));
    printed_ = Clock::now();
    next_share_ = kLineShare * (std::floor(now.share / kLineShare) + 1);
  }
  /// Rays of all stages that trace some.
  void count_rays(const Progress::Snapshot& now) {
    if (now.stage_index != stage_index_)
      rays_ += std::exchange(stage_rays_, 0), stage_index_ = now.stage_index;
    if (now.stage == kRayStage) stage_rays_ = now.total - now.skipped;
  }
  /// As soon as there is a way on: when another process ends, mpirun passes nothing on any more,
  /// and kills this one.
  void say_way_on(const Progress& progress) {
    const std::string way_on = says_way_on_ ? progress.way_on() : std::string();
    if (way_on.empty()) return;
    says_way_on_ = false;
    clear_line();
    print_line(stderr, "finished parts are kept from now on: " + way_on);
  }
  void print_notes(const Progress& progress) {
    for (const std::string& note : progress.notes(notes_)) {
      if (!quiet_) clear_line(), print_line(stderr, note);
      ++notes_;
    }
  }
  void clear_line() const {
    if (terminal_) rewrite_line("");
  }

  bool quiet_, says_way_on_, terminal_;
  size_t notes_ = 0;
  int stage_index_ = -1;
  uint64_t rays_ = 0, stage_rays_ = 0;  ///< of earlier stages, and of the last that was seen
  double next_share_ = kLineShare;
  Clock::time_point printed_ = Clock::now();
};

/// Shows stages as lines of JSON: "stage" for each that has ended, "progress" while one runs.
class ProgressEvents {
 public:
  void show(const Progress& progress) {
    const Progress::Snapshot now = progress.snapshot();
    print_notes(progress);
    if (now.stage_index < 0) return;
    print_way_on(progress);
    print_finished(progress, size_t(now.stage_index));
    nlohmann::json event{{"event", "progress"},     {"stage", now.stage},
                         {"done", now.done},        {"total", now.total},
                         {"share", nullptr},        {"overall", nullptr},
                         {"seconds_left", nullptr}, {"stage_seconds", now.stage_seconds}};
    if (now.total > 0) event["share"] = double(now.done) / double(now.total);
    if (now.seconds_left >= 0) event["seconds_left"] = now.seconds_left;
    if (now.share >= 0) event["overall"] = now.share;
    print_event(event);
  }
  void end(const Progress& progress, bool succeeded) {
    print_notes(progress);
    const size_t begun = progress.stages().size();
    print_finished(progress, succeeded || begun == 0 ? begun : begun - 1);
  }

 private:
  void print_notes(const Progress& progress) {
    for (const std::string& note : progress.notes(notes_)) {
      print_event({{"event", "note"}, {"message", note}});
      ++notes_;
    }
  }
  void print_way_on(const Progress& progress) {
    const std::string way_on = progress.way_on();
    if (way_on == way_on_) return;
    way_on_ = way_on;
    print_event({{"event", "resumable"}, {"message", way_on}});
  }
  void print_finished(const Progress& progress, size_t count) {
    const std::vector<Stage> stages = progress.stages();
    for (; printed_ < count; ++printed_)
      print_event({{"event", "stage"},
                   {"stage", stages[printed_].name},
                   {"seconds", stages[printed_].seconds}});
  }

  size_t printed_ = 0, notes_ = 0;
  std::string way_on_;
};

/// Waits for one of stop_signals() at most a tenth of a second. True when it came.
bool stop_requested() {
  const sigset_t stop = stop_signals();
  const timespec patience{0, 100'000'000};
  return sigtimedwait(&stop, nullptr, &patience) > 0;
}

/// State of the work: the worker writes it, the watcher waits for it.
enum class Work { running, succeeded, failed };

template <class Shown>
void watch(Progress& progress, const std::atomic<Work>& work, const Common& common, Shown line) {
  Clock::time_point asked{};
  while (work == Work::running) {
    if (stack_has_overflowed()) {
      progress.clean_up();
      end_after_overflow();
    }
    if (stop_requested()) {
      if (asked == Clock::time_point{}) asked = Clock::now();
      progress.request_cancel();
    }
    line.show(progress);
    // Reading a file cannot be asked to stop; writing may finish, so that all files are there.
    const bool late =
        asked != Clock::time_point{} && Clock::now() - asked > std::chrono::milliseconds(700);
    if (late && progress.snapshot().stage != kWriteStage) {
      line.end(progress, false);
      progress.clean_up();
      report({ErrorCode::cancelled, stopped_text(progress)}, common);
      std::fflush(stdout);
      ::_exit(kInterrupted);
    }
  }
  line.end(progress, work == Work::succeeded);
}

}  // namespace

std::string clock_text(double seconds) {
  const long s = long(seconds + 0.5);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
  return fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

Status run_with_progress(const Common& common, const std::function<Status(Progress&)>& work) {
  // Only the watcher takes these signals; the threads that the work starts inherit this mask.
  const sigset_t stop = stop_signals();
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  Progress progress;
  std::atomic<Work> state{Work::running};
  std::thread watcher([&] {
    common.progress_json ? watch(progress, state, common, ProgressEvents())
                         : watch(progress, state, common, ProgressLine(common));
  });
  const auto end = [&](Work how) {
    state = how;
    pthread_kill(watcher.native_handle(), SIGTERM);  // so that it looks at once
    watcher.join();
  };
  try {
    Status done = work(progress);
    if (done) progress.finish();
    end(done ? Work::succeeded : Work::failed);
    // Whichever stage was stopped: the user knows why.
    if (!done && done.error().code == ErrorCode::cancelled)
      return fail(ErrorCode::cancelled, "{}", stopped_text(progress));
    return done;
  } catch (...) {
    end(Work::failed);
    throw;
  }
}

int run_and_print(const Common& common,
                  const std::function<Result<nlohmann::json>(Progress&)>& work,
                  const std::function<void(const nlohmann::json&)>& summary) {
  nlohmann::json json;
  const Status done = run_with_progress(common, [&](Progress& progress) -> Status {
    LUXEL_TRY(json, work(progress));
    return {};
  });
  if (!done) return report(done.error(), common);
  print_warnings(json.value("warnings", std::vector<std::string>()), common);
  if (common.json)
    print_json(stdout, json);
  else if (!common.quiet)
    summary(json);
  return kDone;
}

}  // namespace luxel::cli
