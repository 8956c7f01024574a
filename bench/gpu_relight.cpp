// luxel bench gpu-relight: a lamp that moves in the Cornell box, relit by a graphics device beside
// the processor.
#include <algorithm>

#include "bench/bench.h"
#include "luxel/base/differences.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/device/device_relighter.h"
#include "luxel/solve/matrix/relight.h"

namespace luxel::bench {
namespace {

constexpr int kMoves = 15;
/// The goal is for the largest.
constexpr std::array<size_t, 2> kPatchCounts{8192, 65536}, kFewPatches{256, 1024};
constexpr float kGoalError = 0.01f;
constexpr double kGoal_ms = 2;

scene::PunctualLight lamp_at(int move) {
  scene::PunctualLight lamp;
  lamp.position = {0.1f + 0.02f * float(move), 0.4f, 0.3f};
  return lamp;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::vector<float> luminances_of(std::span<const Rgb> light) {
  std::vector<float> out;
  for (const Rgb& l : light) out.push_back(luminance(l));
  return out;
}

Status measure_relight_of(size_t patches, const gpu::Device& device, Table& table) {
  const scene::Scene scene = scene::cornell_box();
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  matrix::RelightParams params;
  params.patches.count = patches;
  params.codec = matrix::CodecKind::hierarchical, params.max_error = kGoalError;
  Progress progress;
  LUXEL_TRY(const matrix::RelightData data,
            matrix::make_relight_data(scene, tracer, {}, params, progress));
  LUXEL_TRY(auto on_device, device::DeviceRelighter::make(device, data));
  LUXEL_TRY(matrix::Relighter on_processor, matrix::Relighter::make(data, {}));
  std::vector<double> processor_ms, device_ms;
  matrix::Relit found;
  for (int move = 0; move < kMoves; ++move) {
    const scene::PunctualLight lamp = lamp_at(move);
    on_processor.update({{&lamp, 1}});
    processor_ms.push_back(on_processor.seconds().total() * 1e3);
    LUXEL_TRY_STATUS(on_device.update({{&lamp, 1}}));
    device_ms.push_back(on_device.seconds() * 1e3);
  }
  LUXEL_TRY_STATUS(on_device.read(found));
  const Differences d =
      differences(luminances_of(found.indirect), luminances_of(on_processor.latest().indirect));
  table.rows.push_back({std::to_string(data.size()), fmt::format("{:.2f}", median(processor_ms)),
                        fmt::format("{:.2f}", median(device_ms)), fmt::format("{:.0f}", kGoal_ms),
                        fmt::format("{:.5f}", 100 * d.rms)});
  table.json.push_back({{"patches", data.size()},
                        {"processor_ms", median(processor_ms)},
                        {"device_ms", median(device_ms)},
                        {"rms_difference", d.rms}});
  return {};
}

}  // namespace

Result<Table> measure_gpu_relight(const std::filesystem::path&, int threads) {
  const ThreadLimit limit(threads);
  Table table =
      new_table("gpu-relight", {"patches", "an update, processor [ms]", "an update, device [ms]",
                                "goal [ms]", "RMS difference [% of the mean]"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  const bool is_software = device->type == VK_PHYSICAL_DEVICE_TYPE_CPU;
  for (const size_t patches : is_software ? kFewPatches : kPatchCounts)
    LUXEL_TRY_STATUS(measure_relight_of(patches, *device, table));
  return table;
}

}  // namespace luxel::bench
