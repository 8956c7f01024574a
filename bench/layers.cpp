// luxel bench layers: what a lightmap for each of 20 lamps costs besides that of all.
#include <cmath>

#include "bench/bake_files.h"
#include "bench/bench.h"
#include "luxel/base/parallel.h"
#include "luxel/export/baked_glb.h"
#include "luxel/scene/shapes.h"

namespace luxel::bench {
namespace {

constexpr int kLayerRounds = 3, kLamps = 20;

/// A lamp of the room's grid, 5 x 4: twelve points, four spots and four panels.
void add_lamp(scene::Scene& scene, int k, uint32_t panel) {
  const float x = 0.8f + 1.6f * float(k % 5), z = 0.8f + 1.5f * float(k / 5);
  if (k % 5 == 4) {
    scene::add_rectangle(scene, {x - 0.3f, x + 0.3f, z - 0.2f, z + 0.2f}, 2.95f, false, panel);
    scene.instances.back().name = fmt::format("panel {}", k);
    return;
  }
  scene::PunctualLight lamp;
  lamp.name = fmt::format("lamp {}", k);
  if (k % 5 == 3) lamp.kind = scene::PunctualLight::Kind::spot;
  lamp.position = {x, 2.6f, z};
  const float hue = 2 * kPi * float(k) / float(kLamps);
  lamp.intensity = Rgb{1 + std::cos(hue), 1 + std::cos(hue - 2), 1 + std::cos(hue + 2)} * 1.5f;
  scene.lights.push_back(lamp);
}

/// A room of 8 x 3 x 6.4 m with a table, a shelf and a pillar under 20 lamps.
scene::Scene room_of_lamps() {
  scene::Scene scene;
  const uint32_t plaster = scene::add_material(scene, "plaster", {0.7f, 0.68f, 0.65f});
  const uint32_t wood = scene::add_material(scene, "wood", {0.5f, 0.3f, 0.15f});
  const uint32_t paint = scene::add_material(scene, "paint", {0.15f, 0.5f, 0.2f});
  const uint32_t panel = scene::add_material(scene, "panel", {}, {6, 5.5f, 5});
  scene::Mesh walls;
  scene::add_box(walls, {0, 0, 0}, {8, 3, 6.4f}, plaster);
  for (auto& triangle : walls.triangles) std::swap(triangle[1], triangle[2]);  // seen from inside
  scene::place(scene, std::move(walls));
  const auto add_block = [&](Vec3 lower, Vec3 upper, uint32_t material) {
    scene::Mesh block;
    scene::add_box(block, lower, upper, material);
    scene::place(scene, std::move(block));
  };
  add_block({2, 0.65f, 2}, {4, 0.7f, 3.5f}, wood);
  add_block({6.5f, 0.01f, 4}, {7.5f, 2, 5.5f}, paint);
  add_block({5, 0.01f, 1}, {5.4f, 2.99f, 1.4f}, plaster);
  for (int k = 0; k < kLamps; ++k) add_lamp(scene, k, panel);
  return scene;
}

/// The largest difference of the layers' sum to the lightmap, relative to its value or, where that
/// is smaller, to the mean.
Result<double> sum_error(const std::filesystem::path& folder, const nlohmann::json& layers) {
  LUXEL_TRY(const image::Image whole, exr_at(folder / "lightmap.exr"));
  std::vector<double> sum(whole.data.size());
  for (const nlohmann::json& layer : layers) {
    LUXEL_TRY(const image::Image own, exr_at(folder / layer["files"][0].get<std::string>()));
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += double(own.data[i]);
  }
  double mean = 0, largest = 0;
  size_t covered = 0;
  for (size_t i = 0; i + 3 < sum.size(); i += 4)
    if (whole.data[i + 3] > 0)
      mean += double(whole.data[i] + whole.data[i + 1] + whole.data[i + 2]) / 3, ++covered;
  mean /= double(std::max<size_t>(1, covered));
  for (size_t i = 0; i < sum.size(); ++i)
    if (i % 4 != 3)
      largest = std::max(largest, std::abs(sum[i] - double(whole.data[i])) /
                                      std::max(mean, double(whole.data[i])));
  return largest;
}

}  // namespace

Result<Table> measure_layers(const std::filesystem::path&, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("layers", {"atlas", "lights", "one bake, s", "with --layers per-light, s",
                                     "ratio", "largest error of the sum"});
  const TemporaryFolder folder("luxel-bench-layers");
  LUXEL_TRY(const std::vector<std::byte> glb, export_::scene_glb(room_of_lamps()));
  LUXEL_TRY_STATUS(write_file_atomically(folder.path / "room.glb", glb));
  for (const int resolution : {256, 512}) {
    pipeline::BakeSettings settings;
    settings.scene = folder.path / "room.glb";
    settings.resolution = resolution;
    settings.threads = threads;
    // Both bakes in turn.
    TimedFiles alone, layered;
    for (int round = 0; round < kLayerRounds; ++round) {
      settings.output = folder.path / "one", settings.layers = light::LayerMode::none;
      LUXEL_TRY_STATUS(time_again(settings, alone));
      settings.output = folder.path / "all", settings.layers = light::LayerMode::per_light;
      LUXEL_TRY_STATUS(time_again(settings, layered));
    }
    // Difference between the sum of the layers and the lightmap.
    const nlohmann::json& layers = layered.report["layers"];
    LUXEL_TRY(const double error, sum_error(settings.output, layers));
    const double ratio = layered.seconds / alone.seconds;
    table.rows.push_back({fmt::format("{0} x {0}", resolution), fmt::format("{}", layers.size()),
                          fmt::format("{:.2f}", alone.seconds),
                          fmt::format("{:.2f}", layered.seconds), fmt::format("{:.2f}", ratio),
                          fmt::format("{:.1e}", error)});
    table.json.push_back({{"resolution", resolution},
                          {"layers", layers.size()},
                          {"seconds", alone.seconds},
                          {"seconds_with_layers", layered.seconds},
                          {"ratio", ratio},
                          {"sum_error", error}});
  }
  table.notes.push_back(fmt::format(
      "A room of 8 x 6.4 m with 16 lamps and 4 panels, 256 samples, all bounces, files included. "
      "Seconds are the best of {} rounds in turn. The error is that of the largest channel of all "
      "texels, relative to the lightmap's value or, where that is smaller, to its mean.",
      kLayerRounds));
  return table;
}

}  // namespace luxel::bench
