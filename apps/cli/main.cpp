// The `luxel` command: argv in, exit code out. Each subcommand is a file beside this one.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "apps/cli/cli.h"
#include "luxel/cluster/mpi.h"
#include "luxel/pipeline/settings/version.h"

namespace {

/// One sentence, and where the options are listed.
std::string usage_message(const CLI::App& app, const CLI::Error& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const std::string command = chosen.empty() ? "luxel" : "luxel " + chosen.front()->get_name();
  std::string text = error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return fmt::format("{}; '{} --help' lists what there is", text, command);
}

/// "luxel 0.1.0, with Open MPI 4.1.4".
std::string version_text() {
  const std::string mpi = luxel::cluster::mpi_version();
  return fmt::format("luxel {}, {}", luxel::pipeline::kVersion,
                     mpi.empty() ? "without MPI" : "with " + mpi);
}

bool is_command(const CLI::App& app, const std::string& name) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  return std::any_of(commands.begin(), commands.end(),
                     [&](const CLI::App* command) { return command->get_name() == name; });
}

/// The first argument when it should be a command and is none.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-' || is_command(app, argv[1])) return {};
  return argv[1];
}

/// Whether --json was asked for, where the arguments make no sense as a whole.
bool wants_json(int argc, char** argv) {
  return std::any_of(argv, argv + argc,
                     [](const char* argument) { return std::string_view(argument) == "--json"; });
}

int run(int argc, char** argv) {
  using namespace luxel::cli;
  CLI::App app{
      "luxel: diffuse global illumination. A scene in, lightmaps out.\n"
      "Try: luxel bake SCENE -o FOLDER",
      "luxel"};
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  Action action;
  register_bake(app, action);
  register_merge(app, action);
  register_render(app, action);
  register_compare(app, action);
  register_info(app, action);
  register_factors(app, action);
  register_probe(app, action);
  register_lux(app, action);
  register_relight(app, action);
  register_bench(app, action);
  if (argc == 1) {
    std::fputs(app.help().c_str(), stderr);
    return kUsage;
  }
  if (const std::string name = unknown_command(app, argc, argv); !name.empty()) {
    return report_usage(
        fmt::format("there is no command '{}'; 'luxel --help' lists what there is", name),
        {.json = wants_json(argc, argv)});
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help and version end with code 0; everything else is wrong usage.
    if (error.get_exit_code() == 0) return code_after_output(app.exit(error));
    return report_usage(usage_message(app, error), {.json = wants_json(argc, argv)});
  }
  return code_after_output(action());
}

/// A standard stream that is closed would give its number to the next file that is opened, and what
/// is printed would go into that. From here on writing to it is an error.
void keep_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
}

constexpr const char* kNoMemory =
    "out of memory; lower --resolution or --samples, or set --max-memory";

/// Whether an allocation has ever failed.
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
    std::fprintf(stderr, "luxel: %s\n", kNoMemory);
    std::_Exit(luxel::cli::kOutOfResource);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "luxel: internal error: %s; please report this\n", error.what());
  } catch (...) {
  }
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  keep_standard_streams();
  std::set_new_handler(note_end_of_memory);
  std::set_terminate(end_without_memory);
  luxel::cli::say_when_the_stack_overflows(wants_json(argc, argv));
  // A limit on the size of files is an error of the write like any other.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return luxel::cli::report({luxel::ErrorCode::out_of_memory, kNoMemory},
                              {.json = wants_json(argc, argv)});
  } catch (const std::exception& error) {
    return luxel::cli::report("internal", luxel::cli::kBadInput,
                              fmt::format("internal error: {}; please report this", error.what()),
                              {.json = wants_json(argc, argv)});
  }
}
