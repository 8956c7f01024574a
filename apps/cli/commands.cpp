// The commands of `luxel`.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "apps/cli/cli.h"

namespace luxel::cli {
namespace {

namespace fs = std::filesystem;

/// Replaces this process by luxel-bench, which lies beside luxel. Returns only if that fails.
int start_bench(const std::vector<std::string>& arguments) {
  std::error_code ignored;
  const std::string program =
      fs::read_symlink("/proc/self/exe", ignored).replace_filename("luxel-bench").string();
  std::string command = "bench";
  std::vector<char*> argv{const_cast<char*>(program.c_str()), command.data()};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  return report({ErrorCode::io,
                 fmt::format("luxel bench needs the program {}, which cannot be started; build it "
                             "in luxel's source tree with: make luxel-bench",
                             program)},
                {});
}

/// The benchmarks are a program of their own, so that luxel is built without them. That program
/// reads all arguments, --help included.
void register_bench(CLI::App& app, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", kAboutBench);
  bench->set_help_flag();
  bench->prefix_command();
  bench->callback([bench, &action] {
    action = [arguments = bench->remaining()] { return start_bench(arguments); };
  });
}

}  // namespace

void register_commands(CLI::App& app, Action& action) {
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
  register_doctor(app, action);
  register_import_any(app, action);
}

}  // namespace luxel::cli
