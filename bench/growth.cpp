#include "bench/growth.h"

#include <unistd.h>

#include <functional>
#include <utility>

#include "bench/child.h"
#include "bench/large_scenes.h"
#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/export/plot.h"
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

/// Size, memory and time of a bake.
struct Grown {
  Growth of;
  uint64_t triangles = 0, texels = 0, peak_bytes = 0;
  double seconds = 0;
  double layout_s = 0;  ///< charts and packing
  double leaks_s = 0;   ///< walls and samples

  double peak_mb() const { return double(peak_bytes) / 1e6; }
};

Result<Grown> bake_one(const Growth& growth, const std::filesystem::path& folder, int threads) {
  const pipeline::BakeSettings settings = settings_of(growth, folder, threads);
  LUXEL_TRY(const ChildOutcome made,
            run_in_child([&] { return write_scene(growth, settings.scene); }));
  if (!made.text.empty()) return fail(ErrorCode::io, "{}", made.text);
  LUXEL_TRY(const nlohmann::json json, bake_in_child(settings));
  const auto of_stages = [&](std::initializer_list<const char*> stages) {
    double sum = 0;
    for (const char* stage : stages) sum += json["seconds"].value(stage, 0.0);
    return sum;
  };
  return Grown{.of = growth,
               .triangles = json["counts"]["triangles"],
               .texels = json["counts"]["texels"],
               .peak_bytes = json["peak_memory_bytes"],
               .seconds = of_stages({"total"}),
               .layout_s = of_stages({"charts", "packing"}),
               .leaks_s = of_stages({"walls", "samples"})};
}

Result<std::vector<Grown>> bake_all(const std::string& series, int threads, Progress& progress) {
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("luxel-bench-{}", ::getpid());
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  std::vector<Grown> out;
  const auto bake = [&]() -> Status {
    for (const Growth& growth : all_bakes()) {
      if (!series.empty() && growth.series != series) continue;
      progress.begin(fmt::format("{} {}", growth.scene, growth.resolution), 0);
      LUXEL_TRY(Grown grown, bake_one(growth, folder, threads));
      out.push_back(std::move(grown));
      LUXEL_TRY_STATUS(stopped(progress));
    }
    return {};
  };
  const Status done = bake();
  std::filesystem::remove_all(folder, ignored);
  LUXEL_TRY_STATUS(done);
  if (out.empty())
    return fail(ErrorCode::bad_setting,
                "--scene {}: growth has the series texels, triangles, copies and large", series);
  return out;
}

Table table_of(const std::vector<Grown>& all) {
  Table table = new_table("growth", {"series", "scene", "triangles", "atlas", "texels", "seconds",
                                     "charts and packing, s", "walls and samples, s",
                                     "peak memory, MB", "bytes per texel"});
  for (const Grown& g : all)
    table.rows.push_back({g.of.series, g.of.scene, fmt::format("{}", g.triangles),
                          fmt::format("{0} x {0}", g.of.resolution), fmt::format("{}", g.texels),
                          fmt::format("{:.1f}", g.seconds), fmt::format("{:.1f}", g.layout_s),
                          fmt::format("{:.1f}", g.leaks_s), fmt::format("{:.0f}", g.peak_mb()),
                          fmt::format("{:.0f}", double(g.peak_bytes) / double(g.texels))});
  return table;
}

using Number = double (*)(const Grown&);
double texels_of(const Grown& g) { return double(g.texels); }
double triangles_of(const Grown& g) { return double(g.triangles); }
double seconds_of(const Grown& g) { return g.seconds; }
double peak_mb_of(const Grown& g) { return g.peak_mb(); }

struct Line {
  std::string series, name;
};

/// On logarithmic axes, with a line of the slope 1 through the largest.
PageFile plot_of(const std::vector<Grown>& all, const std::string& file, const char* title,
                 const std::vector<Line>& lines, std::pair<const char*, Number> x,
                 std::pair<const char*, Number> y) {
  export_::Plot plot;
  plot.title = title, plot.x_label = x.first, plot.y_label = y.first;
  plot.log_x = plot.log_y = true;
  for (const Line& line : lines) {
    export_::Series series{line.name, {}};
    for (const Grown& g : all)
      if (g.of.series == line.series) series.points.push_back({x.second(g), y.second(g)});
    if (series.points.empty()) continue;
    plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) {
    const auto& points = plot.series.front().points;
    const double from = points.front()[0], to = points.back()[0], top = points.back()[1];
    plot.series.push_back(
        {"in proportion", {{from, top * from / to}, {to, top}}, export_::Stroke::dashed});
  }
  return svg_file(file, export_::svg(plot));
}

std::vector<PageFile> plots_of(const std::vector<Grown>& all) {
  const std::pair<const char*, Number> texels{"texels", texels_of},
      triangles{"triangles", triangles_of}, seconds{"seconds", seconds_of},
      peak{"peak memory, MB", peak_mb_of};
  const std::vector<Line> maps{{"texels", "hills of 20,000 triangles"}},
      scenes{{"triangles", "hills, each triangle stored"}, {"copies", "copies of one rock"}};
  return {plot_of(all, "texels-time.svg", "Time of a bake against texels", maps, texels, seconds),
          plot_of(all, "texels-memory.svg", "Memory of a bake against texels", maps, texels, peak),
          plot_of(all, "triangles-time.svg", "Time of a bake of 2048 x 2048 texels", scenes,
                  triangles, seconds),
          plot_of(all, "triangles-memory.svg", "Memory of a bake of 2048 x 2048 texels", scenes,
                  triangles, peak)};
}

}  // namespace

Result<GrowthPage> measure_growth(const std::string& series, int threads, Progress& progress) {
  LUXEL_TRY(const std::vector<Grown> all, bake_all(series, threads, progress));
  GrowthPage page;
  page.tables = {table_of(all)};
  page.pictures = plots_of(all);
  page.csv =
      "series,scene,triangles,atlas_side,texels,seconds,layout_s,leaks_s,peak_memory_bytes\n";
  for (const Grown& g : all) {
    page.csv += fmt::format("{},{},{},{},{},{:.2f},{:.2f},{:.2f},{}\n", g.of.series, g.of.scene,
                            g.triangles, g.of.resolution, g.texels, g.seconds, g.layout_s,
                            g.leaks_s, g.peak_bytes);
    page.json.push_back({{"series", g.of.series},
                         {"scene", g.of.scene},
                         {"triangles", g.triangles},
                         {"resolution", g.of.resolution},
                         {"texels", g.texels},
                         {"seconds", g.seconds},
                         {"peak_memory_bytes", g.peak_bytes}});
  }
  return page;
}

}  // namespace luxel::bench
