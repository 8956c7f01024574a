// `luxel bench NAME`: the tables in docs/. Each table is a file beside this one.
#include <cstdio>
#include <cstdlib>

#include "apps/cli/bench.h"
#include "apps/cli/cli.h"

namespace luxel::cli {
namespace {

struct BenchOptions {
  Common common;
  std::string name;
  std::string shared;
};

std::filesystem::path default_shared() {
  if (const char* folder = std::getenv("LUXEL_SHARED")) return folder;
  return "../shared";
}

int run_bench(const BenchOptions& options) {
  const std::filesystem::path shared =
      options.shared.empty() ? default_shared() : std::filesystem::path(options.shared);
  for (const Bench& bench : kBenches) {
    if (options.name != "all" && options.name != bench.name) continue;
    const auto table = bench.run(shared, options.common);
    if (!table) return report(table.error());
    if (options.common.json)
      std::printf("%s\n", table->json.dump(2).c_str());
    else
      std::printf("%s\n", markdown(*table).c_str());
  }
  return kDone;
}

}  // namespace

std::string machine_name() {
  std::string model = "unknown processor";
  if (FILE* file = std::fopen("/proc/cpuinfo", "r")) {
    char line[512];
    while (std::fgets(line, sizeof line, file)) {
      const std::string_view text(line);
      if (!text.starts_with("model name")) continue;
      model = text.substr(text.find(':') + 2);
      model.erase(model.find_last_not_of('\n') + 1);
      break;
    }
    std::fclose(file);
  }
  return model;
}

std::string markdown(const Table& table) {
  std::string text = fmt::format("### luxel bench {}\n\n{}, {} threads\n\n", table.name,
                                 machine_name(), table.threads);
  const auto row = [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) text += "| " + cell + " ";
    text += "|\n";
  };
  row(table.columns);
  row(std::vector<std::string>(table.columns.size(), "---"));
  for (const auto& cells : table.rows) row(cells);
  for (const std::string& note : table.notes) text += "\n" + note + "\n";
  return text;
}

void register_bench(CLI::App& app, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", "Print the tables of docs/benchmarks.md");
  auto options = std::make_shared<BenchOptions>();
  std::vector<std::string> names{"all"};
  for (const Bench& b : kBenches) names.emplace_back(b.name);
  bench->add_option("NAME", options->name, "Which table")->check(CLI::IsMember(names))->required();
  bench->add_option("--shared", options->shared,
                    "Folder with scenes/ (default: $LUXEL_SHARED, else ../shared)");
  add_common(*bench, options->common);
  bench->callback([options, &action] { action = [options] { return run_bench(*options); }; });
}

}  // namespace luxel::cli
