// The benchmarks behind `luxel bench`.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/cli.h"
#include "base/result.h"

namespace luxel::cli {

/// What a benchmark prints. A row whose scene is not on this machine is left out and noted.
struct Table {
  std::string name;
  int threads = 0;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;
  nlohmann::json json;
};

std::string machine_name();
std::string markdown(const Table& table);

using BenchFunction = Result<Table> (*)(const std::filesystem::path& shared, const Common&);

/// Gather's rays per second against a bare loop of rtcIntersect1 over the same rays.
Result<Table> bench_rays(const std::filesystem::path& shared, const Common& common);
/// The Cornell box of [Moreno05, table 5.1] at four resolutions.
Result<Table> bench_maps(const std::filesystem::path& shared, const Common& common);
/// Charts, packing and texels of the shared scenes.
Result<Table> bench_atlas(const std::filesystem::path& shared, const Common& common);
/// Peak memory of a 2048 x 2048 bake of the largest scene, with and without --max-memory.
Result<Table> bench_memory(const std::filesystem::path& shared, const Common& common);
/// Gather with one and with two threads.
Result<Table> bench_threads(const std::filesystem::path& shared, const Common& common);

struct Bench {
  std::string_view name;
  BenchFunction run;
};
inline constexpr std::array kBenches{Bench{"rays", bench_rays}, Bench{"maps", bench_maps},
                                     Bench{"atlas", bench_atlas}, Bench{"memory", bench_memory},
                                     Bench{"threads", bench_threads}};

}  // namespace luxel::cli
