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

/// A bake of a scene made by code.
struct Growth {
  std::string series;
  std::string scene;
  std::function<scene::Scene()> make;
  int resolution = 1024;
};

std::vector<Growth> all_bakes() {
  std::vector<Growth> out;
  for (const int side : {1024, 2048, 4096, 8192, 16384})
    out.push_back({"texels", "hills", [] { return hills(100); }, side});
  for (const int quads : {71, 224, 707, 2236})
    out.push_back({"triangles", "hills", [=] { return hills(quads); }, 2048});
  for (const int copies : {1, 10, 100, 122})
    out.push_back({"copies", "rocks", [=] { return rocks(copies == 122 ? 6 : 4, copies); }, 2048});
  out.push_back({"large", "hills", [] { return hills(2236); }, 8192});
  out.push_back({"large", "rocks", [] { return rocks(6, 122); }, 8192});
  return out;
}

}  // namespace

Result<Table> measure_growth_of(const std::filesystem::path&, const std::string& series,
                                int threads) {
  Table table = new_table(
      "growth", {"series", "scene", "triangles", "atlas", "texels", "time, s", "peak memory, MiB"});
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("luxel-bench-{}", ::getpid());
  std::filesystem::create_directories(folder);
  for (const Growth& growth : all_bakes()) {
    if (!series.empty() && growth.series != series) continue;
    pipeline::BakeSettings settings;
    settings.scene = folder / "scene.glb";
    settings.output = folder / "baked";
    settings.resolution = growth.resolution;
    settings.samples = 16, settings.direct_samples = {}, settings.supersample = {};
    settings.threads = threads;
    settings.checkpoint_s = 0;
    settings.max_memory_bytes = uint64_t(20) << 30;
    LUXEL_TRY(const ChildOutcome made, run_in_child([&]() -> std::string {
                const auto bytes = export_::scene_glb(growth.make());
                if (!bytes) return bytes.error().message;
                const Status written = write_file_atomically(settings.scene, *bytes);
                return written ? "" : written.error().message;
              }));
    if (!made.text.empty()) return fail(ErrorCode::io, "{}", made.text);
    LUXEL_TRY(const ChildOutcome child, run_in_child([&] {
                Progress progress;
                const auto json = pipeline::bake(settings, progress);
                return json ? json->dump() : nlohmann::json(json.error().message).dump();
              }));
    const auto json = nlohmann::json::parse(child.text, nullptr, false);
    if (!json.is_object()) return fail(ErrorCode::bad_input, "{}", child.text);
    table.rows.push_back({growth.series, growth.scene, json["counts"]["triangles"].dump(),
                          fmt::format("{0} x {0}", growth.resolution),
                          json["counts"]["texels"].dump(),
                          fmt::format("{:.1f}", json["seconds"]["total"].get<double>()),
                          mib(json["peak_memory_bytes"])});
    fmt::print(stderr, "{}\n", json.dump(1));
    table.json.push_back(json);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return table;
}

Result<Table> measure_growth(const std::filesystem::path& shared, int threads) {
  return measure_growth_of(shared, "", threads);
}

}  // namespace luxel::bench
