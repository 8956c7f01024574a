// The benchmarks behind `luxel bench`: every speed and memory figure in docs/ comes from here.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::bench {

/// Output of a benchmark. A row whose scene is not on this machine is left out and noted.
struct Table {
  std::string name;
  int threads = 0;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;
  nlohmann::json json;
};

/// Without rows, for as many threads as loops use now.
Table new_table(std::string name, std::vector<std::string> columns);
/// A share as a cell: 0.1 is "10.00 %".
std::string percent(double share);
/// Bytes as a cell, in MiB.
std::string mib(uint64_t bytes);
/// The processor's model name, or "unknown processor".
std::string machine_name();
/// The table and its notes as Markdown.
std::string markdown(const Table& table);

/// A benchmark. `shared` is the folder with scenes/; `threads` as everywhere, 0 = all. Errors:
/// those of what is measured.
using BenchFunction = Result<Table> (*)(const std::filesystem::path& shared, int threads);

/// Gather's rays per second against a bare loop of rtcIntersect1 over the same rays.
Result<Table> measure_rays(const std::filesystem::path& shared, int threads);
/// Rays per second of a graphics device against those of the processor.
Result<Table> measure_gpu(const std::filesystem::path& shared, int threads);
/// Gather's first round and its sweeps on a graphics device against those of the processor.
Result<Table> measure_gpu_gather(const std::filesystem::path& shared, int threads);
/// Direct light on a graphics device against that of the processor.
Result<Table> measure_gpu_direct(const std::filesystem::path& shared, int threads);
/// The boxes of [Rodriguez06, section 5.8] by hemicubes of a graphics device against those of the
/// processor.
Result<Table> measure_gpu_hemicube(const std::filesystem::path& shared, int threads);
/// Updates of moved lamps on a graphics device against those on the processor.
Result<Table> measure_gpu_relight(const std::filesystem::path& shared, int threads);
/// The light of whole bakes with a graphics device against that of the processor: [Moreno05, table
/// 5.1], five scenes to an error, and maps that grow.
Result<Table> measure_gpu_bake(const std::filesystem::path& shared, int threads);
/// Rays per second of a graphics device as scenes grow.
Result<Table> measure_gpu_growth(const std::filesystem::path& shared, int threads);
/// Those of rays that texels share the directions of, against gather's own: an experiment.
Result<Table> measure_bundles(const std::filesystem::path& shared, int threads);
/// The Cornell box of [Moreno05, table 5.1] at four resolutions.
Result<Table> measure_maps(const std::filesystem::path& shared, int threads);
/// Charts, packing and texels of the shared scenes.
Result<Table> measure_atlas(const std::filesystem::path& shared, int threads);
/// Peak memory of a 2048 x 2048 bake of the largest scene, with and without --max-memory.
Result<Table> measure_memory(const std::filesystem::path& shared, int threads);
/// Gather with one and with two threads.
Result<Table> measure_threads(const std::filesystem::path& shared, int threads);
/// Errors of gather with and without --denoise against a bake of many samples.
Result<Table> measure_denoise(const std::filesystem::path& shared, int threads);
/// Shared scenes under sun and sky, a map against the path tracer, real light and many lamps.
Result<Table> measure_scenes(const std::filesystem::path& shared, int threads);

/// Cost of averaging direct light over texels, and the error that it takes away.
Result<Table> measure_supersample(const std::filesystem::path& shared, int threads);

/// Seconds to 1 % against the path tracer, adaptive against uniform rays, plans, times left and
/// time budgets against what came. Half an hour, most of it of paths.
Result<Table> measure_budget(const std::filesystem::path& shared, int threads);
/// Those of one scene, by its file's stem. Errors: no scene of that name.
Result<Table> measure_budget_in(const std::filesystem::path& shared, const std::string& scene,
                                int threads);

/// Cost of a lightmap for each of 20 lamps besides that of all.
Result<Table> measure_layers(const std::filesystem::path& shared, int threads);

/// Cost of a bake after an edit that builds on a kept one (docs/method/rebake.md).
Result<Table> measure_rebake(const std::filesystem::path& shared, int threads);

/// FLIP of pictures of bakes of each quality against a long one, and processor seconds.
Result<Table> measure_quality(const std::filesystem::path& shared, int threads);

/// Stated and true errors of bakes that are asked for a root mean square error. An hour.
Result<Table> measure_rms(const std::filesystem::path& shared, int threads);
/// Its rows of one scene, by the file's stem. Errors: no scene has this name.
Result<Table> measure_rms_in(const std::filesystem::path& shared, const std::string& scene,
                             int threads);

/// The rows of one scene alone, by its file's stem.
using SceneBenchFunction = Result<Table> (*)(const std::filesystem::path& shared,
                                             const std::string& scene, int threads);

struct Bench {
  std::string_view name;
  BenchFunction run;
  SceneBenchFunction run_in = nullptr;  ///< null: of all scenes together only
};
inline constexpr std::array kBenches{Bench{"rays", measure_rays},
                                     Bench{"maps", measure_maps},
                                     Bench{"atlas", measure_atlas},
                                     Bench{"memory", measure_memory},
                                     Bench{"threads", measure_threads},
                                     Bench{"denoise", measure_denoise},
                                     Bench{"scenes", measure_scenes},
                                     Bench{"supersample", measure_supersample},
                                     Bench{"budget", measure_budget, measure_budget_in},
                                     Bench{"layers", measure_layers},
                                     Bench{"rebake", measure_rebake},
                                     Bench{"quality", measure_quality},
                                     Bench{"rms", measure_rms, measure_rms_in},
                                     Bench{"bundles", measure_bundles},
                                     Bench{"gpu", measure_gpu},
                                     Bench{"gpu-gather", measure_gpu_gather},
                                     Bench{"gpu-direct", measure_gpu_direct},
                                     Bench{"gpu-hemicube", measure_gpu_hemicube},
                                     Bench{"gpu-relight", measure_gpu_relight},
                                     Bench{"gpu-bake", measure_gpu_bake},
                                     Bench{"gpu-growth", measure_gpu_growth}};

}  // namespace luxel::bench
