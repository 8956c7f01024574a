// Declarations that the commands of `luxel` share.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "luxel/arguments/table_options.h"
#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/settings/import_options.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::cli {

using namespace arguments;  // options from tables

enum ExitCode { kDone = 0, kBadInput = 1, kUsage = 2, kOutOfResource = 3, kInterrupted = 130 };

/// Options that every command has; --threads unless the command has one of its own.
struct Common {
  int threads = 0;
  bool quiet = false;  ///< neither progress nor warnings nor a summary as text
  bool json = false;
  bool progress_json = false;     ///< all that stderr gets is JSON; `quiet` is set then, too
  bool silent = false;            ///< no errors, either: another process says them
  std::string* unsaid = nullptr;  ///< gets those that are not said
  bool in_team = false;           ///< started by mpirun, which kills it when another process ends
  std::string settings{};         ///< --settings, where no other part of the command has it
};
/// Adds them as the last options of a command, whose SCENE is there by then.
void add_common(CLI::App& command, Common& common);

/// --smooth-normals, --up, --unit, --search-path, --trust-paths, --any-format.
std::vector<CLI::Option*> add_import(CLI::App& command, Given& given);
/// --background, --sun, --environment, --sky and --ies.
std::vector<CLI::Option*> add_outside_light(CLI::App& command, Given& given);

/// Wrong usage unless the text is a whole number from 0 to `most`; CLI11 takes -1 for a large one.
CLI::Validator whole_number(uint64_t most = UINT64_MAX);

/// "x,y,z".
Result<DVec3> parse_point(const char* option, const std::string& text);

/// [x, y, z], as --json has places.
inline nlohmann::json point_json(DVec3 p) { return {p.x, p.y, p.z}; }

/// Prints the error's sentence to stderr, or an event of --progress-json, and, with --json, an
/// object with it to stdout. Returns its exit code.
int report(const Error& error, const Common& common);
/// Wrong usage, said in the same two places. Returns kUsage.
int report_usage(const std::string& message, const Common& common);
/// report() of a fault that no ErrorCode stands for. `code` is its name in {"error": {"code":
/// "internal", "exit_code": 1, "message": "..."}}. Returns `exit_code`.
int report(std::string_view code, int exit_code, const std::string& message, const Common& common);
/// One line of JSON on stderr; docs/guide/ci.md lists the events.
void print_event(const nlohmann::json& event);
/// A sentence that is no warning, unless --quiet was given.
void print_note(const std::string& note, const Common& common);

/// "42 s", "1:05 min", "2:10 h".
std::string clock_text(double seconds);

void print_warnings(const std::vector<std::string>& warnings, const Common& common);

/// Runs `work` while a second thread shows its progress on stderr and turns Ctrl-C into a request
/// to stop. When the work does not stop within a second, the process ends with code 130; nothing is
/// half written then, because files and folders appear when everything else is done.
Status run_with_progress(const Common& common, const std::function<Status(Progress&)>& work);

/// Runs work that ends in a JSON object, with its `warnings` or none; prints those, and the object
/// or, when it was not asked for, a summary of it. Returns the exit code.
int run_and_print(const Common& common,
                  const std::function<Result<nlohmann::json>(Progress&)>& work,
                  const std::function<void(const nlohmann::json&)>& summary);

/// The exit code of a command that ended with `code`: results that standard output did not take are
/// an error.
int code_after_output(int code, const Common& common);

/// From here on an overflow of this thread's stack ends the process with a sentence and code 1:
/// readers of other libraries call themselves for what lies in each other in a file. It is said as
/// `messages` are wanted. Another thread that finds that the stack has overflowed has half a second
/// to clean up, and ends the process.
void say_when_the_stack_overflows(const Common& messages);
bool stack_has_overflowed();
[[noreturn]] void end_after_overflow();

/// A command registers itself in `app` and, when it was asked for, leaves what is to be done.
using Action = std::function<int()>;
void register_info(CLI::App& app, Action& action);
void register_probe(CLI::App& app, Action& action);
void register_lux(CLI::App& app, Action& action);
void register_bake(CLI::App& app, Action& action);
void register_merge(CLI::App& app, Action& action);
void register_render(CLI::App& app, Action& action);
void register_compare(CLI::App& app, Action& action);
void register_factors(CLI::App& app, Action& action);
void register_relight(CLI::App& app, Action& action);
void register_doctor(CLI::App& app, Action& action);
void register_import_any(CLI::App& app, Action& action);

/// Registers the program's commands: all in luxel, bench alone in luxel-bench.
void register_commands(CLI::App& app, Action& action);
inline constexpr const char* kAboutBench =
    "Print the tables of docs/bench/benchmarks.md, or write docs/bench/validation.md or "
    "docs/guide/gallery.md";

}  // namespace luxel::cli
