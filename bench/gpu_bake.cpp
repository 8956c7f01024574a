// luxel bench gpu-bake: the light of whole bakes by gather, with a graphics device beside the
// processor alone.
#include "bench/bench.h"
#include "bench/scenes_of_rays.h"
#include "luxel/base/clock.h"
#include "luxel/base/differences.h"
#include "luxel/base/parallel.h"
#include "luxel/gpu/device.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/device/gather_device.h"
#include "luxel/solve/gather/gather.h"

namespace luxel::bench {
namespace {

constexpr double kAskedError = 0.01;
/// Scenes below shared/scenes, as `luxel bench budget` plans them, and the side of their maps.
constexpr std::array kErrorScenes{"cornell_box/cornell_box.glb", "living_room/living_room.glb",
                                  "tile_game_room/tile_game_room6.glb", "suzanne_room/room.glb",
                                  "kaykit_city/kaykit_city.glb"};
constexpr int kErrorResolution = 512;
/// Where a processor plays the device: the first ones alone, smaller.
constexpr size_t kFewScenes = 2;
constexpr int kFewTexels = 128;
/// Sides of maps of the Cornell box with so few samples that most of the work is that of texels.
constexpr std::array kGrowingSides{1024, 2048, 4096, 8192};
constexpr int kGrowingSamples = 16;

struct TimedLight {
  gather::Gather light;
  double seconds = 0;
};
Result<TimedLight> timed(const validate::Prepared& p, const gather::GatherParams& params,
                         gather::RayDevice* device) {
  Progress progress;
  const auto start = Clock::now();
  gather::GatherStores stores;
  stores.scratch_folder = std::filesystem::temp_directory_path(), stores.device = device;
  LUXEL_TRY(gather::Gather light, gather::gather(p.input(), nullptr, params, stores, {}, progress));
  return TimedLight{std::move(light), seconds_since(start)};
}

std::vector<float> luminances_of_light(std::span<const Rgb> light) {
  std::vector<float> out;
  for (const Rgb& l : light) out.push_back(luminance(l));
  return out;
}

/// The light of a scene on both; the device's second time counts.
Status add_bake(const std::string& what, scene::Scene scene, int resolution,
                const gather::GatherParams& params, gather::RayDevice& device, Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), resolution, progress));
  if (p->tracer->has_tints()) {
    table.notes.push_back(what + " is left out: the device knows no coloured glass");
    return {};
  }
  LUXEL_TRY(const TimedLight expected, timed(*p, params, nullptr));
  LUXEL_TRY(TimedLight found, timed(*p, params, &device));
  LUXEL_TRY(found, timed(*p, params, &device));
  const Differences d = differences(luminances_of_light(found.light.irradiance),
                                    luminances_of_light(expected.light.irradiance));
  table.rows.push_back({what, std::to_string(p->elements.size()),
                        fmt::format("{:.1f}", double(expected.light.rays) * 1e-6),
                        fmt::format("{:.3f}", expected.seconds),
                        fmt::format("{:.3f}", found.seconds),
                        fmt::format("{:.1f}", expected.seconds / found.seconds),
                        fmt::format("{:.4f}", 100 * d.rms), fmt::format("{:.5f}", 100 * d.bias)});
  table.json.push_back({{"what", what},
                        {"texels", p->elements.size()},
                        {"rays", expected.light.rays},
                        {"processor_s", expected.seconds},
                        {"device_s", found.seconds},
                        {"rms_difference", d.rms},
                        {"bias", d.bias}});
  return {};
}

/// [Moreno05, table 5.1]: 200 direct and 800 indirect samples.
Status add_paper(bool is_card, gather::RayDevice& device, Table& table) {
  gather::GatherParams params;
  params.direct_samples = is_card ? 200 : 20, params.samples = is_card ? 800 : 80;
  return add_bake(
      fmt::format("Cornell box, {} + {} samples", params.direct_samples, params.samples),
      scene::cornell_box(), is_card ? 512 : kFewTexels, params, device, table);
}

Status add_errors(const std::filesystem::path& shared, bool is_card, gather::RayDevice& device,
                  Table& table) {
  gather::GatherParams params;
  params.samples = 64, params.direct_samples = 64, params.supersample = 16;
  params.max_error = float(kAskedError), params.error_measure = gather::ErrorMeasure::rms;
  const size_t count = is_card ? kErrorScenes.size() : kFewScenes;
  for (const std::filesystem::path file : std::span(kErrorScenes).first(count)) {
    const NamedScene named{file.stem().string(), shared / "scenes" / file};
    if (!is_here(named, table)) continue;
    LUXEL_TRY(scene::Scene scene, load(named));
    LUXEL_TRY_STATUS(
        add_bake(fmt::format("{} to an RMS error of {:.0f} %", named.name, 100 * kAskedError),
                 std::move(scene), is_card ? kErrorResolution : kFewTexels, params, device, table));
  }
  return {};
}

Status add_growth(bool is_card, gather::RayDevice& device, Table& table) {
  gather::GatherParams params;
  params.samples = params.direct_samples = kGrowingSamples;
  for (const int side : kGrowingSides) {
    if (!is_card && side > kGrowingSides.front()) break;
    LUXEL_TRY_STATUS(
        add_bake(fmt::format("Cornell box, {0} x {0}, {1} samples", side, kGrowingSamples),
                 scene::cornell_box(), side, params, device, table));
  }
  return {};
}

}  // namespace

Result<Table> measure_gpu_bake(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table(
      "gpu-bake", {"bake", "texels", "rays [millions]", "processor [s]", "with the device [s]",
                   "ratio", "RMS difference [% of the mean]", "bias [%]"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  const auto rays = device::gather_device(*device);
  // Less of it where a processor plays the device.
  const bool is_card = device->type != VK_PHYSICAL_DEVICE_TYPE_CPU;
  LUXEL_TRY_STATUS(add_paper(is_card, *rays, table));
  LUXEL_TRY_STATUS(add_errors(shared, is_card, *rays, table));
  LUXEL_TRY_STATUS(add_growth(is_card, *rays, table));
  return table;
}

}  // namespace luxel::bench
