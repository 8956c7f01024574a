// luxel bench growth: time and memory of bakes as maps and scenes grow.
#include <unistd.h>

#include <functional>

#include "bench/bench.h"
#include "bench/child.h"
#include "bench/large_scenes.h"
#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/bake/bake.h"

namespace luxel::bench {
namespace {

constexpr uint64_t kMostMemory = uint64_t(20'000'000'000);

/// A bake of a scene made by code.
struct Growth {
  std::string series, scene;
  std::function<scene::Scene()> make;
  int resolution = 2048;
};

/// Rocks of 20 * 4^k triangles.
constexpr int kFineRock = 6, kCoarseRock = 4;

std::vector<Growth> all_bakes() {
  std::vector<Growth> out;
  for (const int side : {1024, 2048, 4096, 8192, 16384})
    out.push_back({"texels", "hills", [] { return hills(100); }, side});
  for (const int quads : {71, 224, 707, 1265})
    out.push_back({"triangles", "hills", [quads] { return hills(quads); }});
  for (const int copies : {2, 20, 200, 600})
    out.push_back({"copies", "rocks", [copies] { return rocks(kCoarseRock, copies); }});
  out.push_back({"large", "hills", [] { return hills(2236); }, 8192});
  out.push_back({"large", "rocks", [] { return rocks(kFineRock, 122); }, 8192});
  return out;
}

/// Few rays: what grows with texels and triangles alone shows.
pipeline::BakeSettings settings_of(const Growth& growth, const std::filesystem::path& folder,
                                   int threads) {
  pipeline::BakeSettings out;
  out.scene = folder / "scene.glb", out.output = folder / "baked";
  out.resolution = growth.resolution;
  out.samples = 8, out.direct_samples = 4, out.supersample = 1;
  out.threads = threads;
  out.checkpoint_s = 0;
  out.max_memory_bytes = kMostMemory;
  return out;
}

/// In a process of its own. Returns why it could not.
std::string write_scene(const Growth& growth, const std::filesystem::path& file) {
  const auto bytes = export_::scene_glb(growth.make());
  if (!bytes) return bytes.error().message;
  const Status written = write_file_atomically(file, *bytes);
  return written ? std::string() : written.error().message;
}

Status add_bake(const Growth& growth, const std::filesystem::path& folder, int threads,
                Table& table) {
  const pipeline::BakeSettings settings = settings_of(growth, folder, threads);
  LUXEL_TRY(const ChildOutcome made,
            run_in_child([&] { return write_scene(growth, settings.scene); }));
  if (!made.text.empty()) return fail(ErrorCode::io, "{}", made.text);
  LUXEL_TRY(const nlohmann::json json, bake_in_child(settings));
  const auto seconds = [&](std::initializer_list<const char*> stages) {
    double sum = 0;
    for (const char* stage : stages) sum += json["seconds"].value(stage, 0.0);
    return fmt::format("{:.1f}", sum);
  };
  const uint64_t triangles = json["counts"]["triangles"], texels = json["counts"]["texels"];
  const uint64_t peak = json["peak_memory_bytes"];
  table.rows.push_back({growth.series, growth.scene, fmt::format("{}", triangles),
                        fmt::format("{0} x {0}", growth.resolution), fmt::format("{}", texels),
                        seconds({"total"}), seconds({"charts", "packing"}),
                        seconds({"walls", "samples"}), fmt::format("{}", peak / 1'000'000)});
  table.json.push_back(json);
  return {};
}

}  // namespace

Result<Table> measure_growth_of(const std::filesystem::path&, const std::string& series,
                                int threads) {
  Table table =
      new_table("growth", {"series", "scene", "triangles", "atlas", "texels", "seconds",
                           "charts and packing, s", "walls and samples, s", "peak memory, MB"});
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("luxel-bench-{}", ::getpid());
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  Status done;
  for (const Growth& growth : all_bakes())
    if (done && (series.empty() || growth.series == series))
      done = add_bake(growth, folder, threads, table);
  std::filesystem::remove_all(folder, ignored);
  LUXEL_TRY_STATUS(done);
  if (table.rows.empty())
    return fail(ErrorCode::bad_setting,
                "--scene {}: growth has the series texels, triangles, copies and large", series);
  return table;
}

Result<Table> measure_growth(const std::filesystem::path& shared, int threads) {
  return measure_growth_of(shared, "", threads);
}

}  // namespace luxel::bench
