// luxel bench gpu-hemicube: whole solutions of the paper's boxes by hemicubes of a graphics device,
// beside those of the processor. [Rodriguez06, section 5.8]
#include <algorithm>

#include "bench/bench.h"
#include "bench/hemicube.h"
#include "luxel/base/parallel.h"
#include "luxel/gpu/device.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/device/device_look.h"

namespace luxel::bench {
namespace {

constexpr float kElement_m = 0.2f;  ///< the paper's tessellation factor 20
constexpr int kBoxPixels = 64, kBoxPasses = 10;

struct Box {
  const char* name;
  scene::Scene scene;
  double goal_ms;
};

/// The fastest of some runs.
Result<BoxRun> fastest_run(const Box& box, int runs, hemicube::LookDevice* device) {
  Progress progress;
  std::optional<BoxRun> best;
  for (int k = 0; k < runs; ++k) {
    LUXEL_TRY(BoxRun run,
              run_box("", box.scene, kElement_m, kBoxPixels, kBoxPasses, progress, device));
    if (!best || run.seconds < best->seconds) best = std::move(run);
  }
  return std::move(*best);
}

}  // namespace

Result<Table> measure_gpu_hemicube(const std::filesystem::path&, int threads) {
  const ThreadLimit limit(threads);
  Table table =
      new_table("gpu-hemicube", {"box", "vertices", "processor [ms]", "with the device [ms]",
                                 "of this, the device [ms]", "goal [ms]", "mean light, ratio"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  const auto look = device::look_device(*device);
  const int runs = device->type == VK_PHYSICAL_DEVICE_TYPE_CPU ? 1 : 5;
  const std::array<Box, 2> boxes{
      {{"empty", scene::radiosity_box(), 20},
       {"with sphere and torus", scene::radiosity_box_with_shapes(), 60}}};
  for (const Box& box : boxes) {
    LUXEL_TRY(const BoxRun expected, fastest_run(box, runs, nullptr));
    LUXEL_TRY(const BoxRun found, fastest_run(box, runs, look.get()));
    table.rows.push_back(
        {box.name, std::to_string(found.vertices), fmt::format("{:.1f}", expected.seconds * 1e3),
         fmt::format("{:.1f}", found.seconds * 1e3),
         fmt::format("{:.1f}", found.look.visibility * 1e3), fmt::format("{:.0f}", box.goal_ms),
         fmt::format("{:.6f}", found.mean_irradiance / expected.mean_irradiance)});
    table.json.push_back({{"box", box.name},
                          {"vertices", found.vertices},
                          {"processor_s", expected.seconds},
                          {"with_device_s", found.seconds},
                          {"device_s", found.look.visibility},
                          {"mean_ratio", found.mean_irradiance / expected.mean_irradiance}});
  }
  return table;
}

}  // namespace luxel::bench
