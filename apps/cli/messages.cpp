// Messages of commands on stderr, and as JSON on stdout.
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <unistd.h>

#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "apps/cli/terminal.h"
#include "luxel/base/file.h"
#include "luxel/base/shown_text.h"

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

/// The value of "code" in an error's JSON.
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

}  // namespace

void print_event(const nlohmann::json& event) { print_json(stderr, event, -1); }

int report(std::string_view code, int exit_code, const std::string& whole_message,
           const Common& common) {
  const std::string message = short_message(whole_message);
  if (common.silent) {
    if (common.unsaid) *common.unsaid = message;
    return exit_code;
  }
  const nlohmann::json about{{"code", code}, {"exit_code", exit_code}, {"message", message}};
  if (common.progress_json) {
    nlohmann::json event = about;
    event["event"] = "error";
    print_event(event);
  } else {
    print_line(stderr, whole_message, painted("luxel:", Colour::red) + " ");
  }
  if (common.json) print_json(stdout, {{"error", about}});
  return exit_code;
}

int report(const Error& error, const Common& common) {
  return report(name_of(error.code), exit_code(error.code), error.message, common);
}

int report_usage(const std::string& message, const Common& common) {
  return report("usage", kUsage, message, common);
}

void print_warnings(const std::vector<std::string>& warnings, const Common& common) {
  for (const std::string& warning : warnings) {
    if (common.progress_json)
      print_event({{"event", "warning"}, {"message", short_message(warning)}});
    else if (!common.quiet)
      print_line(stderr, warning, painted("warning:", Colour::yellow) + " ");
  }
}

void print_note(const std::string& note, const Common& common) {
  if (common.progress_json)
    print_event({{"event", "note"}, {"message", note}});
  else if (!common.quiet)
    print_line(stderr, note);
}

int code_after_output(int code, const Common& common) {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  int error = errno;
  if ((flushed && !std::ferror(stdout)) || code != kDone) return code;
  // When an earlier write failed, the next one says why; one more line break does no harm then.
  if (flushed && ::write(STDOUT_FILENO, "\n", 1) < 0) error = errno;
  return report({code_of_write(error),
                 fmt::format("cannot write the results to standard output{}{}",
                             error != 0 ? ": " : "", error != 0 ? std::strerror(error) : "")},
                {.progress_json = common.progress_json});
}

}  // namespace luxel::cli
