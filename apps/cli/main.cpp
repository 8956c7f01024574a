// The `luxel` command: argv in, exit code out. Each subcommand is a file beside this one.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>

#include <fmt/ranges.h>

#include "apps/cli/cli.h"
#include "apps/cli/machine.h"
#include "apps/cli/print.h"
#include "luxel/arguments/near_miss.h"
#include "luxel/arguments/option_file.h"
#include "luxel/cluster/mpi.h"

namespace {

using luxel::Status;
using Arguments = std::vector<std::string>;  // without the program's name

/// One sentence, and where the options are listed. A misspelt option is the reason for whatever
/// else is missing.
std::string usage_message(const CLI::App& app, const CLI::Error& error,
                          const Arguments& arguments) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string name = chosen.empty() ? "luxel" : "luxel " + command.get_name();
  std::string text = luxel::arguments::about_unknown_option(command, name, arguments);
  if (text.empty()) text = error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return fmt::format("{}{} '{} --help' lists the options", text, text.ends_with('?') ? "" : ";",
                     name);
}

/// A sentence about the first argument when it should be a command and is none.
std::string about_unknown_command(const CLI::App& app, const Arguments& arguments) {
  if (arguments.empty() || arguments[0].starts_with('-')) return {};
  Arguments names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  if (std::ranges::find(names, arguments[0]) != names.end()) return {};
  const std::string meant = luxel::arguments::did_you_mean(arguments[0], names);
  return fmt::format("there is no command '{}'{}{} 'luxel --help' lists the commands", arguments[0],
                     meant, meant.empty() ? ";" : "");
}

/// Message options of a command line that makes no sense as a whole.
luxel::cli::Common messages_in(int argc, char** argv) {
  const auto has = [&](std::string_view flag) {
    return std::any_of(argv, argv + argc, [&](const char* argument) { return flag == argument; });
  };
  const bool events = has("--progress-json");
  return {.quiet = events || has("--quiet"), .json = has("--json"), .progress_json = events};
}

constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 a file, a scene or a setting is wrong; 2 the command line is wrong;\n"
    "3 not enough memory, disk or time; 130 stopped by Ctrl-C, SIGTERM or SIGHUP.";

/// All commands. What was asked for goes to `action`.
std::unique_ptr<CLI::App> make_app(luxel::cli::Action& action) {
  using namespace luxel::cli;
  auto app = std::make_unique<CLI::App>(
      "luxel: diffuse global illumination. A scene in, lightmaps out.\n"
      "Try: luxel bake SCENE -o FOLDER",
      "luxel");
  app->set_version_flag("--version", [] { return luxel::cli::version_text(); });
  app->require_subcommand(1);
  app->footer(kExitCodes);
  register_commands(*app, action);
  return app;
}

void parse(CLI::App& app, const Arguments& arguments) {
  app.parse(Arguments(arguments.rbegin(), arguments.rend()));  // CLI11 takes the last one first
}

/// The arguments with those of a file of options, before the user's own.
Arguments joined(const Arguments& given, const std::string& command, const Arguments& options) {
  Arguments out = given;
  out.insert(std::ranges::find(out, command) + 1, options.begin(), options.end());
  return out;
}

/// Parses once more where a file of options goes with the command. Errors: those of the file.
Status add_option_file(std::unique_ptr<CLI::App>& app, luxel::cli::Action& action,
                       const Arguments& given, const luxel::cli::Common& messages) {
  const CLI::App& command = *app->get_subcommands().front();
  const auto file = luxel::arguments::option_file_of(command);
  if (!file) return {};
  const std::string name = command.get_name(), path = file->path.string();
  LUXEL_TRY(const Arguments options, luxel::arguments::options_in(*file, command, name));
  if (options.empty()) return {};
  // Each of several processes that work together reads the file.
  if (luxel::cluster::processes_started() == 1)
    luxel::cli::print_note(fmt::format("options from {}: {}", path, fmt::join(options, " ")),
                           messages);
  app = make_app(action);
  try {
    parse(*app, joined(given, name, options));
    return {};
  } catch (const CLI::ParseError& error) {
    return luxel::fail(luxel::ErrorCode::bad_setting,
                       "{}: {}; give --settings none to read no file", path, error.what());
  }
}

int run(int argc, char** argv) {
  using namespace luxel::cli;
  const Arguments given(argv + std::min(argc, 1), argv + argc);
  const Common messages = messages_in(argc, argv);
  Action action;
  std::unique_ptr<CLI::App> app = make_app(action);
  if (given.empty()) {
    print_own(stderr, app->help());
    return kUsage;
  }
  if (const std::string unknown = about_unknown_command(*app, given); !unknown.empty())
    return report_usage(unknown, messages);
  try {
    parse(*app, given);
  } catch (const CLI::ParseError& error) {
    // Help and version end with code 0; everything else is wrong usage.
    if (error.get_exit_code() == 0) return code_after_output(app->exit(error), messages);
    return report_usage(usage_message(*app, error, given), messages);
  }
  if (const Status added = add_option_file(app, action, given, messages); !added)
    return report(added.error(), messages);
  return code_after_output(action(), messages);
}

/// A standard stream that is closed would give its number to the next file that is opened, and what
/// is printed would go into that. From here on writing to it is an error.
void keep_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
}

constexpr const char* kNoMemory =
    "out of memory; lower --resolution or --samples, or set --max-memory";

/// True once an allocation has failed.
std::atomic<bool>& memory_has_ended() {
  static constinit std::atomic<bool> has_ended{false};
  return has_ended;
}
void note_end_of_memory() {
  memory_has_ended() = true;
  throw std::bad_alloc();
}

/// Memory that ends where no exception can be passed on, as in a library's noexcept function: the
/// sentence and the code are those of main(). Anything else is a fault, and leaves its trace.
/// Where such a function was inlined, GCC 12 does not make its exception the current one.
[[noreturn]] void end_without_memory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
    if (std::uncaught_exceptions() > 0 && memory_has_ended()) throw std::bad_alloc();
  } catch (const std::bad_alloc&) {
    for (const char* text : {"luxel: ", kNoMemory, "\n"}) luxel::cli::print_own(stderr, text);
    std::_Exit(luxel::cli::kOutOfResource);
  } catch (const std::exception& error) {
    luxel::cli::print_line(
        stderr, fmt::format("luxel: internal error: {}; please report this", error.what()));
  } catch (...) {
  }
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  keep_standard_streams();
  std::set_new_handler(note_end_of_memory);
  std::set_terminate(end_without_memory);
  luxel::cli::say_when_the_stack_overflows(messages_in(argc, argv));
  // A limit on the size of files is an error of the write like any other.
  std::signal(SIGXFSZ, SIG_IGN);
  // So is a pipe whose reader has gone: what is said on the way is lost, and files are written.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return luxel::cli::report({luxel::ErrorCode::out_of_memory, kNoMemory},
                              messages_in(argc, argv));
  } catch (const std::exception& error) {
    return luxel::cli::report("internal", luxel::cli::kBadInput,
                              fmt::format("internal error: {}; please report this", error.what()),
                              messages_in(argc, argv));
  }
}
