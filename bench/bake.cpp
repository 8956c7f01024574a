// luxel bench atlas, memory: what a bake of the shared scenes takes.
#include <unistd.h>

#include "bench/bench.h"
#include "bench/child.h"
#include "luxel/atlas/atlas.h"
#include "luxel/base/parallel.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

/// Two instances of the first instance's mesh, side by side: the 139,000 triangles of the goal.
void double_up(scene::Scene& scene) {
  const Box3 box = scene::world_bounds(scene);
  scene::Instance copy = scene.instances.front();
  copy.world_from_object =
      translation({1.2f * (box.upper.x - box.lower.x), 0, 0}) * copy.world_from_object;
  scene.instances.push_back(copy);
}

struct AtlasCase {
  std::string name;
  std::string file;
  int resolution = 2048;
  bool twice = false;
};

}  // namespace

Result<Table> measure_atlas(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table{"atlas",
              thread_count(),
              {"scene", "triangles", "atlas", "seconds", "charts", "utilisation", "mean L2 stretch",
               "triangles without texel"},
              {},
              {},
              nlohmann::json::array()};
  for (const AtlasCase& c :
       {AtlasCase{"suzanne_room", "suzanne_room/room.glb"}, AtlasCase{"zdm2", "zdm2/zdm2.glb"},
        AtlasCase{"two bunnies", "spot_teapot_bunny/stanford-bunny.obj", 2048, true},
        AtlasCase{"pandora", "pandora/pandora.obj"},
        AtlasCase{"kaykit_city", "kaykit_city/kaykit_city.glb"},
        AtlasCase{"japanese_bridge_garden", "japanese_bridge_garden/japanese_bridge_garden.glb"},
        AtlasCase{"living_room", "living_room/living_room.glb"}}) {
    const auto file = shared / "scenes" / c.file;
    if (!std::filesystem::exists(file)) {
      table.notes.push_back(file.string() + " is not on this machine: left out");
      continue;
    }
    // Unwraps the scene.
    LUXEL_TRY(import::Imported imported, import::import_scene(file));
    if (c.twice) double_up(imported.scene);
    atlas::AtlasParams params;
    params.resolution = c.resolution;
    params.uv = atlas::UvMode::unwrap;
    Progress progress;
    const auto start = Clock::now();
    LUXEL_TRY(const atlas::Atlas atlas, atlas::make_atlas(imported.scene, params, progress));
    const double seconds = seconds_since(start);
    // Measures of the atlas.
    const atlas::TexelMap map = atlas::rasterise(imported.scene, atlas);
    const atlas::AtlasStats s = atlas::atlas_stats(imported.scene, atlas, map);
    table.rows.push_back({c.name, fmt::format("{}", atlas.corners.size()),
                          fmt::format("{0} x {0}", c.resolution), fmt::format("{:.2f}", seconds),
                          fmt::format("{}", s.charts), fmt::format("{:.1f} %", 100 * s.utilisation),
                          fmt::format("{:.3f}", s.mean_stretch_l2),
                          fmt::format("{}", s.triangles_without_texel)});
    table.json.push_back({{"scene", c.name},
                          {"seconds", seconds},
                          {"charts", s.charts},
                          {"utilisation", s.utilisation},
                          {"mean_stretch_l2", s.mean_stretch_l2},
                          {"triangles_without_texel", s.triangles_without_texel}});
  }
  return table;
}

Result<Table> measure_memory(const std::filesystem::path& shared, int threads) {
  Table table{
      "memory",
      threads == 0 ? thread_count() : threads,
      {"--max-memory", "peak memory, MiB", "seconds", "texels", "hits in the temporary file, MiB"},
      {},
      {},
      nlohmann::json::array()};
  const auto file = shared / "scenes/suzanne_room/room.glb";
  if (!std::filesystem::exists(file)) {
    table.notes.push_back(file.string() + " is not on this machine: left out");
    return table;
  }
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("luxel-bench-{}", ::getpid());
  // Bakes in a process of their own, whose peak is theirs alone.
  for (const char* cap : {"", "1G"}) {
    pipeline::BakeSettings settings;
    settings.scene = file;
    settings.output = folder;
    settings.resolution = 2048;
    settings.samples = 64;
    settings.threads = threads;
    if (*cap) {
      LUXEL_TRY(settings.max_memory_bytes, pipeline::parse_size(cap));
    }
    LUXEL_TRY(const nlohmann::json json, bake_in_child(settings));
    const auto mib = [](const nlohmann::json& bytes) {
      return fmt::format("{}", bytes.get<uint64_t>() >> 20);
    };
    table.rows.push_back({*cap ? cap : "none", mib(json["peak_memory_bytes"]),
                          fmt::format("{:.1f}", json["seconds"]["total"].get<double>()),
                          fmt::format("{}", json["counts"]["texels"].get<uint64_t>()),
                          mib(json["scratch_bytes"])});
    table.json.push_back(json);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  table.notes.push_back(
      "suzanne_room (63,720 triangles, the largest shared scene), 2048 x 2048, 64 samples.");
  return table;
}

}  // namespace luxel::bench
