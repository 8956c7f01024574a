// `luxel bench NAME`: the tables in docs/. The tables themselves: bench/.
#include <cstdio>
#include <cstdlib>

#include "apps/cli/cli.h"
#include "bench/bench.h"

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
  for (const bench::Bench& table_of : bench::kBenches) {
    if (options.name != "all" && options.name != table_of.name) continue;
    const auto table = table_of.run(shared, options.common.threads);
    if (!table) return report(table.error());
    if (options.common.json)
      std::printf("%s\n", table->json.dump(2).c_str());
    else
      std::printf("%s\n", bench::markdown(*table).c_str());
  }
  return kDone;
}

}  // namespace

void register_bench(CLI::App& app, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", "Print the tables of docs/benchmarks.md");
  auto options = std::make_shared<BenchOptions>();
  std::vector<std::string> names{"all"};
  for (const bench::Bench& b : bench::kBenches) names.emplace_back(b.name);
  bench->add_option("NAME", options->name, "Which table")->check(CLI::IsMember(names))->required();
  bench->add_option("--shared", options->shared,
                    "Folder with scenes/ (default: $LUXEL_SHARED, else ../shared)");
  add_common(*bench, options->common);
  bench->callback([options, &action] { action = [options] { return run_bench(*options); }; });
}

}  // namespace luxel::cli
