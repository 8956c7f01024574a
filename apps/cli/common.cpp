#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include <unistd.h>

#include "apps/cli/cli.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/short_message.h"
#include "luxel/pipeline/settings/bake_settings_options.h"
#include "luxel/pipeline/settings/import_options.h"
#include "luxel/scene/held_range.h"

namespace luxel::cli {
namespace {

/// As the option of `luxel bake` has it, which is a row of a table.
constexpr uint64_t kMostThreads = 1024;
constexpr const char* kStopped = "stopped by the user";

std::string stopped_text(const Progress& progress) {
  const std::string way_on = progress.way_on();
  return way_on.empty() ? kStopped : fmt::format("{}; {}", kStopped, way_on);
}

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

/// What "code" in an error's JSON says.
std::string_view name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_input:
      return "bad_input";
    case ErrorCode::unsupported:
      return "unsupported";
    case ErrorCode::bad_setting:
      return "bad_setting";
    case ErrorCode::io:
      return "io";
    case ErrorCode::out_of_memory:
      return "out_of_memory";
    case ErrorCode::out_of_disk:
      return "out_of_disk";
    case ErrorCode::out_of_time:
      return "out_of_time";
    case ErrorCode::no_device:
      return "no_device";
    case ErrorCode::parts_missing:
      return "parts_missing";
    case ErrorCode::cancelled:
      return "cancelled";
  }
  return "internal";
}

/// Shows stages on stderr: one line that is rewritten on a terminal, and a line that stays for each
/// finished stage.
class ProgressLine {
 public:
  explicit ProgressLine(const Common& common)
      : quiet_(common.quiet),
        says_way_on_(common.in_team),
        terminal_(::isatty(STDERR_FILENO) != 0) {}

  void show(const Progress& progress) {
    const Progress::Snapshot now = progress.snapshot();
    print_notes(progress);
    if (quiet_ || now.stage_index < 0) return;
    say_way_on(progress);
    print_finished(progress, size_t(now.stage_index));
    if (now.stage == "trace rays") rays_ = now.total - now.skipped;
    if (!terminal_) return;
    std::string line = now.stage;
    if (now.total > 0 && now.stage_seconds > 0) {
      line += fmt::format("  {:3.0f} %", 100 * double(now.done) / double(now.total));
      // What was there already has taken no time.
      const double done = double(now.done - now.skipped), total = double(now.total - now.skipped);
      const double share = total > 0 ? done / total : 0;
      if (now.stage == "trace rays")
        line += fmt::format("  {:.1f} Mrays/s", done * 1e-6 / now.stage_seconds);
      // Long work has an estimate early, too.
      const bool known = share > 0.02 || (share > 0 && now.stage_seconds > 3);
      if (known && now.seconds_left < 0)
        line += "  " + clock_text(now.stage_seconds * (1 - share) / share) + " left of this";
    }
    if (now.seconds_left >= 0) line += "  " + clock_text(now.seconds_left) + " left";
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
  }

  /// The work has ended: shows the stages it has finished. After an error the last one is not.
  void end(const Progress& progress, bool succeeded) {
    print_notes(progress);
    if (quiet_) return;
    const size_t begun = progress.stages().size();
    print_finished(progress, succeeded || begun == 0 ? begun : begun - 1);
    if (terminal_) std::fputs("\r\033[K", stderr);
  }

 private:
  /// As soon as there is a way on: when another process ends, mpirun passes nothing on any more,
  /// and kills this one.
  void say_way_on(const Progress& progress) {
    const std::string way_on = says_way_on_ ? progress.way_on() : std::string();
    if (way_on.empty()) return;
    says_way_on_ = false;
    std::fprintf(stderr, "%sfinished parts are kept from now on: %s\n", terminal_ ? "\r\033[K" : "",
                 way_on.c_str());
  }
  void print_notes(const Progress& progress) {
    for (const std::string& note : progress.notes(notes_)) {
      if (!quiet_) std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\033[K" : "", note.c_str());
      ++notes_;
    }
  }
  void print_finished(const Progress& progress, size_t count) {
    const std::vector<Stage> stages = progress.stages();
    for (; printed_ < count; ++printed_) {
      const Stage& stage = stages[printed_];
      std::string line = fmt::format("{:<18}{:7.2f} s", stage.name, stage.seconds);
      if (stage.name == "trace rays" && rays_ > 0 && stage.seconds > 0)
        line += fmt::format("   {:.1f} Mrays/s", double(rays_) * 1e-6 / stage.seconds);
      std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\033[K" : "", line.c_str());
    }
  }

  bool quiet_, says_way_on_, terminal_;
  size_t printed_ = 0, notes_ = 0;
  uint64_t rays_ = 0;
};

sigset_t stop_signals() {
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGINT);
  sigaddset(&stop, SIGTERM);
  return stop;
}

/// Waits for Ctrl-C at most a tenth of a second. True when it came.
bool stop_requested() {
  const sigset_t stop = stop_signals();
  const timespec patience{0, 100'000'000};
  return sigtimedwait(&stop, nullptr, &patience) > 0;
}

/// How the work stands: the worker writes it, the watcher waits for it.
enum class Work { running, succeeded, failed };

void watch(Progress& progress, const std::atomic<Work>& work, const Common& common) {
  using Clock = std::chrono::steady_clock;
  ProgressLine line(common);
  Clock::time_point asked{};
  while (work == Work::running) {
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

void add_common(CLI::App& command, Common& common) {
  if (!command.get_option_no_throw("--threads"))
    command.add_option("--threads", common.threads, "Threads to use; 0 = all cores")
        ->check(whole_number(kMostThreads))
        ->capture_default_str();
  command.add_flag("--quiet", common.quiet, "No progress, no warnings");
  command.add_flag("--json", common.json, "One JSON object on stdout, everything else on stderr");
}

CLI::Validator whole_number(uint64_t most) {
  return {[most](const std::string& text) {
            uint64_t value = 0;
            const char* end = text.data() + text.size();
            const auto [stop, error] = std::from_chars(text.data(), end, value);
            if (error == std::errc() && stop == end && value <= most) return std::string();
            return fmt::format("{} is not a whole number from 0 to {}", text, most);
          },
          ""};
}

Result<Vec3> parse_point(const char* option, const std::string& text) {
  Vec3 p;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%f,%f,%f%c", &p.x, &p.y, &p.z, &rest) != 3)
    return fail(ErrorCode::bad_setting, "{} '{}' is not a point; give x,y,z in metres", option,
                text);
  if (scene::is_held(p)) return p;
  return fail(ErrorCode::bad_setting, "{} '{}' is no place in a scene: coordinates go up to {:g} m",
              option, text, scene::kFarthest_m);
}

std::vector<CLI::Option*> add_import(CLI::App& command, Given& given) {
  return add_options(command, pipeline::import_options(), import::ImportParams{}, given);
}

std::vector<CLI::Option*> add_outside_light(CLI::App& command, Given& given) {
  const auto table = pipeline::outside_light_options();
  const std::vector<CLI::Option*> options =
      add_options(command, table, pipeline::OutsideLight{}, given);
  for (const auto& row : table) exclude_each_other(command, row);
  return options;
}

int report(std::string_view code, int exit_code, const std::string& whole_message,
           const Common& common) {
  const std::string message = short_message(whole_message);
  if (common.silent) {
    if (common.unsaid) *common.unsaid = message;
    return exit_code;
  }
  std::fprintf(stderr, "luxel: %s\n", message.c_str());
  if (!common.json) return exit_code;
  const nlohmann::json json{
      {"error", {{"code", code}, {"exit_code", exit_code}, {"message", message}}}};
  // What is not UTF-8 may stand in a file's name.
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  return exit_code;
}

int report(const Error& error, const Common& common) {
  return report(name_of(error.code), exit_code(error.code), error.message, common);
}

int report_usage(const std::string& message, const Common& common) {
  return report("usage", kUsage, message, common);
}

void print_warnings(const std::vector<std::string>& warnings, const Common& common) {
  if (common.quiet) return;
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "warning: %s\n", short_message(warning).c_str());
}

int code_after_output(int code) {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  int error = errno;
  if ((flushed && !std::ferror(stdout)) || code != kDone) return code;
  // When an earlier write failed, the next one says why; one more line break does no harm then.
  if (flushed && ::write(STDOUT_FILENO, "\n", 1) < 0) error = errno;
  return report({error == ENOSPC ? ErrorCode::out_of_disk : ErrorCode::io,
                 fmt::format("cannot write the results to standard output{}{}",
                             error != 0 ? ": " : "", error != 0 ? std::strerror(error) : "")},
                {});
}

Status run_with_progress(const Common& common, const std::function<Status(Progress&)>& work) {
  // Only the watcher takes Ctrl-C; the threads that the work starts inherit this mask.
  const sigset_t stop = stop_signals();
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  Progress progress;
  std::atomic<Work> state{Work::running};
  std::thread watcher([&] { watch(progress, state, common); });
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
    std::printf("%s\n", json.dump(2).c_str());
  else if (!common.quiet)
    summary(json);
  return kDone;
}

}  // namespace luxel::cli
