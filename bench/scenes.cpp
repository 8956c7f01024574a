// luxel bench scenes: what people would bake. Shared scenes under sun and sky; a map with a sun
// against the path tracer; what real light and many lamps cost.
#include <cmath>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/procedural.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

constexpr std::array kBenchScenes{"cornell_box/cornell_box.glb",
                                  "tile_game_room/tile_game_room6.glb",
                                  "living_room/living_room.glb",
                                  "suzanne_room/room.glb",
                                  "zdm2/zdm2.glb",
                                  "pandora/pandora.obj",
                                  "kaykit_city/kaykit_city.glb",
                                  "japanese_bridge_garden/japanese_bridge_garden.glb",
                                  "japanese_bridge_garden/japanese_bridge_garden_meshopt.glb",
                                  "spot_teapot_bunny/spot.obj",
                                  "spot_teapot_bunny/teapot.obj",
                                  "spot_teapot_bunny/stanford-bunny.obj"};

/// One scene under a morning's sun and sky, 1024 x 1024, as `luxel bake` would.
Status bake_outdoors(const std::filesystem::path& file, Table& table) {
  Progress progress;
  pipeline::BakeSettings settings;
  settings.scene = file;
  settings.output = std::filesystem::temp_directory_path();
  settings.resolution = 1024, settings.samples = 64, settings.direct_samples = 16;
  LUXEL_TRY(settings.outside.sky, pipeline::parse_sky("135,45"));
  const auto start = Clock::now();
  LUXEL_TRY(const pipeline::Bake bake, pipeline::bake_scene(settings, progress));
  const double seconds = seconds_since(start);
  // Size, speed, noise, texels that look wrong, and seams.
  const std::string name = file.stem().string();
  table.rows.push_back({name, fmt::format("{}", bake.atlas.corners.size()),
                        fmt::format("{}", bake.map.texels.size()), fmt::format("{:.1f}", seconds),
                        fmt::format("{:.1f}", double(bake.light.rays) * 1e-6 / seconds),
                        fmt::format("{:.1f} %", 100 * bake.light.relative_error),
                        fmt::format("{:.1f} %", 100 * double(bake.light.suspicious_texels) /
                                                    double(bake.map.texels.size())),
                        fmt::format("{:.2f} %", 100 * bake.seam_residual_after.relative_p95)});
  table.json.push_back({{"scene", name},
                        {"triangles", bake.atlas.corners.size()},
                        {"texels", bake.map.texels.size()},
                        {"seconds", seconds},
                        {"rays", bake.light.rays},
                        {"relative_error", bake.light.relative_error},
                        {"suspicious_texels", bake.light.suspicious_texels},
                        {"seam_residual_p95", bake.seam_residual_after.relative_p95}});
  return {};
}

/// The Cornell box as it is, and under a map with a sun, which shines through its open front.
Status measure_real_light(Table& table) {
  Progress progress;
  // The best of three runs.
  const auto seconds_of = [&](scene::Scene scene) -> Result<double> {
    LUXEL_TRY(const auto p, validate::prepare(std::move(scene), 512, progress));
    double best = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      LUXEL_TRY(const validate::Timed timed, validate::solve(*p, "gather", {}, progress));
      best = std::min(best, timed.seconds);
    }
    return best;
  };
  // A map like a sky with a sun: one texel far brighter than the others.
  scene::Scene real = scene::cornell_box();
  real.environment = {256, 128, std::vector<Rgb>(256 * 128, {0.2f, 0.3f, 0.5f}), 0};
  real.environment.radiance[30 * 256 + 70] = {50000, 45000, 40000};
  LUXEL_TRY(const double plain, seconds_of(scene::cornell_box()));
  LUXEL_TRY(const double with_map, seconds_of(real));
  // Cost of the map over the scene without it.
  table.notes.push_back(fmt::format(
      "Cornell box at 512 x 512, default rays: {:.2f} s; under a map with a sun {:.2f} s, {:.2f} "
      "times as long.",
      plain, with_map, with_map / plain));
  table.json.push_back({{"scene", "Cornell box under a map"},
                        {"seconds", {plain, with_map}},
                        {"ratio", with_map / plain}});
  return {};
}

}  // namespace

Result<Table> measure_scenes(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("scenes", {"scene under sun and sky", "triangles", "texels", "seconds",
                                     "Mrays/s", "estimated error", "in solids", "seams, 95 %"});
  LUXEL_TRY_STATUS(measure_real_light(table));
  LUXEL_TRY_STATUS(measure_lamps(table));
  for (const char* file : kBenchScenes) {
    const auto path = shared / "scenes" / file;
    if (std::filesystem::exists(path))
      LUXEL_TRY_STATUS(bake_outdoors(path, table));
    else
      table.notes.push_back(path.string() + " is not on this machine: left out");
  }
  table.notes.push_back(
      "1024 x 1024 texels, 64 samples, 16 shadow rays, --sky 135,45; seconds of the whole bake, "
      "without writing files.");
  LUXEL_TRY_STATUS(measure_own(table));
  LUXEL_TRY_STATUS(measure_map(shared, table));
  return table;
}

}  // namespace luxel::bench
