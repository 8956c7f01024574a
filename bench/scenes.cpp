// luxel bench scenes: what people would bake. Shared scenes under sun and sky; a map with a sun
// against the path tracer; what real light and many lamps cost.
#include <cmath>

#include "base/parallel.h"
#include "bench/agreement.h"
#include "bench/bench.h"
#include "bench/prepared.h"
#include "import/environment.h"
#include "import/import.h"
#include "pipeline/bake.h"
#include "scene/procedural.h"
#include "scene/shapes.h"

namespace luxel::bench {
namespace {

constexpr std::array kScenes{"cornell_box/cornell_box.glb",
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

/// Gather against the path tracer under a map whose sun is 50,000 times as bright as its mean.
Status measure_map(const std::filesystem::path& shared, Table& table) {
  constexpr int kResolution = 128, kPaths = 4096, kSamples = 1024;
  const auto room = shared / "scenes/living_room/living_room.glb";
  const auto sky = shared / "scenes/sky/kloppenheim_05_1k.hdr";
  if (!std::filesystem::exists(room) || !std::filesystem::exists(sky)) return {};
  Progress progress;
  LUXEL_TRY(import::Imported imported, import::import_scene(room));
  LUXEL_TRY(import::ImportedEnvironment map, import::read_environment(sky, 0, 1));
  imported.scene.environment = std::move(map.map);
  LUXEL_TRY(const auto p, prepare(std::move(imported.scene), kResolution, progress));
  LUXEL_TRY(const Judged judged, judge(*p, kPaths, 1, progress));
  pipeline::BakeSettings settings;
  settings.samples = kSamples, settings.direct_samples = kSamples / 4;
  LUXEL_TRY(const Timed solved, solve(*p, "gather", settings, progress));
  const Agreement a = agreement(solved.light.irradiance, solved.light.hidden, judged);
  table.notes.push_back(
      fmt::format("kloppenheim_05_1k on living_room, {0} x {0}, {1} samples: relative RMSE {2} "
                  "against twice {3} "
                  "paths (resolution {4:.2f} %), bias {5:+.3f} % of the mean, {6:.1f} s; the paths "
                  "took {7:.0f} s.",
                  kResolution, kSamples, relative_rmse_text(a), kPaths, 100 * a.resolution,
                  100 * a.bias_over_mean, solved.seconds, judged.seconds));
  table.json.push_back({{"scene", "living_room under kloppenheim_05_1k"},
                        {"relative_rmse", a.relative_rmse},
                        {"resolution", a.resolution},
                        {"bias_over_mean", a.bias_over_mean},
                        {"seconds", solved.seconds}});
  return {};
}

/// A hall of 20 x 20 m, 4 m high, with n x n square lamps in a grid under its ceiling, or as many
/// point lamps, and some pillars. Every lamp has its share of the same flux.
scene::Scene hall(int n, bool squares) {
  scene::Scene s;
  const Rgb gray{0.6f, 0.6f, 0.6f};
  const uint32_t walls = scene::add_material(s, "walls", gray, {});
  scene::Mesh room;
  room.name = "hall";
  scene::add_box(room, {0, 0, 0}, {20, 4, 20}, walls);
  for (auto& t : room.triangles) std::swap(t[1], t[2]);  // seen from inside
  scene::place(s, std::move(room));
  scene::Mesh pillars;
  pillars.name = "pillars";
  for (int k = 0; k < 9; ++k) {
    const float x = 3.3f + 6.4f * float(k % 3), z = 3.1f + 6.6f * float(k / 3);
    scene::add_box(pillars, {x, 0, z}, {x + 0.5f, 3, z + 0.5f}, walls);
  }
  scene::place(s, std::move(pillars));
  const float share = 1 / float(n * n), side = 0.2f;
  const uint32_t lamp = scene::add_material(
      s, "lamp", {}, Rgb{1, 0.95f, 0.9f} * (squares ? 1000 * share / (kPi * side * side) : 0.0f));
  for (int k = 0; k < n * n; ++k) {
    const float x = 20 * (float(k % n) + 0.5f) / float(n),
                z = 20 * (float(k / n) + 0.5f) / float(n);
    if (squares) {
      scene::add_rectangle(s, {x - side / 2, x + side / 2, z - side / 2, z + side / 2}, 3.9f, false,
                           lamp);
      continue;
    }
    scene::PunctualLight point;
    point.position = {x, 3.9f, z};
    point.intensity = Rgb{1, 0.95f, 0.9f} * (1000 * share / (4 * kPi));
    s.lights.push_back(point);
  }
  return s;
}

struct Cost {
  double seconds = 0, error = 0;
};

/// Seconds and error of a bake with few rays, against one with many.
Result<Cost> cost_of(scene::Scene scene) {
  constexpr int kResolution = 192;
  Progress progress;
  LUXEL_TRY(const auto p, prepare(std::move(scene), kResolution, progress));
  pipeline::BakeSettings settings;
  settings.samples = 64, settings.direct_samples = 32;
  LUXEL_TRY(const Timed few, solve(*p, "gather", settings, progress));
  settings.samples = 1024, settings.direct_samples = 512, settings.seed = 2;
  LUXEL_TRY(const Timed many, solve(*p, "gather", settings, progress));
  return Cost{few.seconds, errors_of(few.light.irradiance, many.light.irradiance, {}).relative};
}

/// Error falls with the root of time, at worst: the time to reach the other's error.
double time_at_equal_error(const Cost& cost, const Cost& other) {
  return cost.seconds * std::pow(cost.error / other.error, 2) / other.seconds;
}

Status measure_lamps(Table& table) {
  for (const bool squares : {true, false}) {
    LUXEL_TRY(const Cost few, cost_of(hall(2, squares)));
    LUXEL_TRY(const Cost many, cost_of(hall(20, squares)));
    const double ratio = time_at_equal_error(many, few);
    table.notes.push_back(fmt::format(
        "Hall with 4 and with 400 {}: {:.2f} s to {:.2f} %, {:.2f} s to {:.2f} %: {:.2f} times the "
        "time at equal error.",
        squares ? "square lamps" : "point lamps", few.seconds, 100 * few.error, many.seconds,
        100 * many.error, ratio));
    table.json.push_back({{"scene", squares ? "hall, square lamps" : "hall, point lamps"},
                          {"seconds", {few.seconds, many.seconds}},
                          {"error", {few.error, many.error}},
                          {"time_at_equal_error", ratio}});
  }
  return {};
}

/// The Cornell box as it is, and under a map with a sun, which shines through its open front.
Status measure_real_light(Table& table) {
  Progress progress;
  const auto seconds_of = [&](scene::Scene scene) -> Result<double> {
    LUXEL_TRY(const auto p, prepare(std::move(scene), 512, progress));
    double best = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      LUXEL_TRY(const Timed timed, solve(*p, "gather", {}, progress));
      best = std::min(best, timed.seconds);
    }
    return best;
  };
  scene::Scene real = scene::cornell_box();
  real.environment = {256, 128, std::vector<Rgb>(256 * 128, {0.2f, 0.3f, 0.5f}), 0};
  real.environment.radiance[30 * 256 + 70] = {50000, 45000, 40000};
  LUXEL_TRY(const double plain, seconds_of(scene::cornell_box()));
  LUXEL_TRY(const double with_map, seconds_of(real));
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
  for (const char* file : kScenes) {
    const auto path = shared / "scenes" / file;
    if (std::filesystem::exists(path))
      LUXEL_TRY_STATUS(bake_outdoors(path, table));
    else
      table.notes.push_back(path.string() + " is not on this machine: left out");
  }
  table.notes.push_back(
      "1024 x 1024 texels, 64 samples, 16 shadow rays, --sky 135,45; seconds of the whole bake, "
      "without writing files.");
  LUXEL_TRY_STATUS(measure_map(shared, table));
  return table;
}

}  // namespace luxel::bench
