// luxel bench hemicube: the paper's two tests, the goals, and how view factors converge.
#include "bench/hemicube.h"

#include <fmt/format.h>

#include "bench/child.h"
#include "luxel/base/parallel.h"
#include "luxel/export/plot.h"
#include "luxel/scene/procedural.h"

namespace luxel::bench {
namespace {

/// The paper's seconds for its whole solutions. [Rodriguez06, plates C.9, C.10]
constexpr double kPaperEmpty_s = 58, kPaperShapes_s = 203;
constexpr float kFactor20_m = 0.20f, kFactor4_m = 0.04f;
constexpr int kHemicube = 64, kPasses = 10;

/// Peak memory of a process that only solves the finest box.
Result<uint64_t> peak_bytes_of_finest() {
  LUXEL_TRY(const ChildOutcome child, run_in_child([] {
              Progress progress;
              const auto run =
                  run_box("", scene::radiosity_box(), kFactor4_m, kHemicube, kPasses, progress);
              return run ? std::string() : run.error().message;
            }));
  if (!child.text.empty())
    return fail(ErrorCode::bad_input, "the finest box failed: {}", child.text);
  return child.peak_resident_bytes;
}

Table table_of(std::string name, std::string first, const std::vector<BoxRun>& runs,
               const std::vector<std::string>& labels) {
  Table t{std::move(name),
          thread_count(),
          {std::move(first), "hemicube", "passes", "vertices", "triangles", "total, s",
           "us per vertex", "visibility", "summation", "rows, MiB"},
          {},
          {},
          nlohmann::json::array()};
  for (size_t i = 0; i < runs.size(); ++i) {
    const BoxRun& r = runs[i];
    const double share = 100 * r.visibility_share();
    t.rows.push_back(
        {labels[i], fmt::format("{}", r.hemicube), fmt::format("{}", r.passes),
         fmt::format("{}", r.vertices), fmt::format("{}", r.triangles),
         fmt::format("{:.3f}", r.seconds), fmt::format("{:.0f}", r.microseconds_per_vertex()),
         fmt::format("{:.0f} %", share), fmt::format("{:.0f} %", 100 - share), mib(r.row_bytes)});
  }
  return t;
}

struct Runs {
  std::vector<BoxRun> whole, complexity, size;
  uint64_t peak_bytes = 0;
  std::vector<FactorErrors> factors;  ///< empty: the exact ones are not on this machine
};

Result<Runs> run_all(const std::filesystem::path& shared, Progress& progress) {
  Runs out;
  progress.begin("memory", 0);
  LUXEL_TRY(out.peak_bytes, peak_bytes_of_finest());
  const scene::Scene empty = scene::radiosity_box(), shapes = scene::radiosity_box_with_shapes();
  const auto add = [&](std::vector<BoxRun>& runs, const char* test, const scene::Scene& scene,
                       float size_m, int hemicube, int passes) -> Status {
    LUXEL_TRY(BoxRun run, run_box(test, scene, size_m, hemicube, passes, progress));
    runs.push_back(std::move(run));
    return {};
  };
  for (const scene::Scene* scene : {&empty, &shapes})
    LUXEL_TRY_STATUS(add(out.whole, "whole", *scene, kFactor20_m, kHemicube, kPasses));
  for (const float size_m : {kFactor20_m, 0.10f, 0.05f, kFactor4_m})
    LUXEL_TRY_STATUS(add(out.complexity, "complexity", empty, size_m, kHemicube, kPasses));
  for (const int n : {8, 16, 64, 128, 256, 512})
    LUXEL_TRY_STATUS(add(out.size, "hemicube size", empty, kFactor20_m, n, 5));
  const std::filesystem::path exact = shared / "reference" / "view-factors.csv";
  if (std::filesystem::exists(exact)) {
    LUXEL_TRY(out.factors, measure_hemicube_factors(exact, progress));
  }
  return out;
}

Table goals_table(const Runs& runs) {
  Table t =
      table_of("hemicube: whole solutions", "box", runs.whole, {"empty", "with sphere and torus"});
  t.columns.push_back("paper, s");
  t.columns.push_back("paper / luxel");
  const std::array<double, 2> paper{kPaperEmpty_s, kPaperShapes_s};
  for (size_t i = 0; i < 2; ++i) {
    t.rows[i].push_back(fmt::format("{:.0f}", paper[i]));
    t.rows[i].push_back(fmt::format("{:.0f}", paper[i] / runs.whole[i].seconds));
  }
  t.notes.push_back(fmt::format(
      "Lamp of radiosity (100.4, 96.8, 90.0). The paper's seconds are a Pentium 4 of 3 GHz with an "
      "X600 Pro (2006); the goals are 1 s and 4 s on 2 cores. Visibility and\nsummation are shares "
      "of the CPU time spent looking. Peak memory of a process that solves the empty box with {} "
      "vertices at {} pixels, {} passes: {} MiB (goal: under 1 GB).",
      runs.complexity.back().vertices, kHemicube, kPasses, mib(runs.peak_bytes)));
  return t;
}

std::string error_text(double error) { return fmt::format("{:.4f} %", 100 * error); }

Table factors_table(const std::vector<FactorErrors>& factors) {
  Table t{"hemicube: view factors of unit squares",
          thread_count(),
          {"hemicube", "parallel, mean", "parallel, one hemicube", "perpendicular, mean",
           "perpendicular, one hemicube"},
          {},
          {},
          nlohmann::json::array()};
  // Parallel squares come first, then perpendicular ones.
  const size_t half = factors.size() / 2;
  for (size_t i = 0; i < half; ++i) {
    const FactorErrors &a = factors[i], &b = factors[half + i];
    t.rows.push_back({fmt::format("{}", a.hemicube), error_text(a.of_mean), error_text(a.of_one),
                      error_text(b.of_mean), error_text(b.of_one)});
  }
  if (half == 0) {
    t.notes.push_back("shared/reference/view-factors.csv is not on this machine: left out");
    return t;
  }
  t.notes.push_back(
      "Relative errors: parallel at distance 1, perpendicular with a common edge. The solver's own "
      "hemicubes look from the 8 x 8 points of Gauss's rule on one square at the\nother. `mean`: "
      "their weighted mean against the exact F between the squares. A cube's floor sees its "
      "ceiling and four walls,\nwhose shares sum to 1 for any "
      "hemicube, so the perpendicular mean errs by a quarter of the parallel one. `one hemicube`: "
      "root mean square over the points, each against\nthe exact F from that point. Only pixels on "
      "the outline can be wrong: some 1/n of them, of either sign, so errors fall as 1/n or "
      "faster. The goal at 512 is 0.5 %.");
  return t;
}

export_::Series series(std::string name, const std::vector<BoxRun>& runs,
                       double (*x)(const BoxRun&), double (*y)(const BoxRun&)) {
  export_::Series s{std::move(name), {}};
  for (const BoxRun& r : runs) s.points.push_back({x(r), y(r)});
  return s;
}

/// Over a logarithmic axis.
export_::Plot plot(const char* title, const char* x_label, const char* y_label) {
  export_::Plot p;
  p.title = title, p.x_label = x_label, p.y_label = y_label;
  p.log_x = true;
  return p;
}

double vertices_of(const BoxRun& r) { return double(r.vertices); }
double size_of(const BoxRun& r) { return double(r.hemicube); }
double time_of(const BoxRun& r) { return r.microseconds_per_vertex(); }

std::vector<PageFile> plots_of(const Runs& runs) {
  export_::Plot complexity =
      plot("Time per vertex against the model's complexity", "vertices", "microseconds per vertex");
  complexity.series = {series("64 pixels, 10 passes", runs.complexity, vertices_of, time_of)};
  double highest = 0;
  for (const BoxRun& r : runs.complexity) highest = std::max(highest, time_of(r));
  complexity.y_range = {{0, 1.1 * highest}};

  export_::Plot size = plot("Time per vertex against the hemicube's size", "pixels along an edge",
                            "microseconds per vertex");
  size.log_y = true;
  size.y_range = {{0.5 * time_of(runs.size.front()), 2 * time_of(runs.size.back())}};
  size.series = {series("774 vertices, 5 passes", runs.size, size_of, time_of)};
  // In proportion to the pixels, as far as it is in the picture.
  const BoxRun& last = runs.size.back();
  export_::Series square{"as the square of the size", {}, export_::Stroke::dashed};
  for (const BoxRun& r : runs.size) {
    const double ratio = size_of(r) / size_of(last);
    const double time = time_of(last) * ratio * ratio;
    if (time > (*size.y_range)[0]) square.points.push_back({size_of(r), time});
  }
  size.series.push_back(std::move(square));

  export_::Plot share = plot("Where the looking's time goes",
                             "pixels along an edge of the hemicube", "share of CPU time, %");
  share.y_range = {{0, 100}};
  share.series = {series("visibility", runs.size, size_of,
                         [](const BoxRun& r) { return 100 * r.visibility_share(); }),
                  series("summation", runs.size, size_of,
                         [](const BoxRun& r) { return 100 - 100 * r.visibility_share(); })};
  return {svg_file("complexity.svg", export_::svg(complexity)),
          svg_file("size.svg", export_::svg(size)), svg_file("share.svg", export_::svg(share))};
}

void write_run(const BoxRun& r, HemicubePage& page) {
  page.csv += fmt::format("{},{},{},{},{},{},{:.6f},{:.3f},{:.6f},{:.6f},{},{:.6g}\n", r.test,
                          r.scene, r.hemicube, r.passes, r.vertices, r.triangles, r.seconds,
                          r.microseconds_per_vertex(), r.look.visibility, r.look.summation,
                          r.row_bytes, r.mean_irradiance);
  page.json["runs"].push_back({{"test", r.test},
                               {"scene", r.scene},
                               {"hemicube", r.hemicube},
                               {"passes", r.passes},
                               {"vertices", r.vertices},
                               {"triangles", r.triangles},
                               {"seconds", r.seconds},
                               {"visibility_cpu_seconds", r.look.visibility},
                               {"summation_cpu_seconds", r.look.summation},
                               {"row_bytes", r.row_bytes},
                               {"mean_irradiance", r.mean_irradiance}});
}

}  // namespace

Result<HemicubePage> measure_hemicube(const std::filesystem::path& shared, Progress& progress) {
  LUXEL_TRY(const Runs runs, run_all(shared, progress));
  HemicubePage page;
  page.tables = {goals_table(runs),
                 table_of("hemicube: test 1, complexity", "tessellation factor", runs.complexity,
                          {"20", "10", "5", "4"}),
                 table_of("hemicube: test 2, size", "box", runs.size,
                          std::vector<std::string>(runs.size.size(), "empty")),
                 factors_table(runs.factors)};
  page.pictures = plots_of(runs);
  page.csv =
      "test,scene,hemicube,passes,vertices,triangles,seconds,us_per_vertex,visibility_cpu_s,"
      "summation_cpu_s,row_bytes,mean_irradiance\n";
  page.json = {{"peak_memory_bytes", runs.peak_bytes}, {"runs", nlohmann::json::array()}};
  for (const auto* group : {&runs.whole, &runs.complexity, &runs.size})
    for (const BoxRun& r : *group) write_run(r, page);
  for (const FactorErrors& f : runs.factors)
    page.json["view_factors"].push_back({{"case", f.name},
                                         {"hemicube", f.hemicube},
                                         {"error_of_mean", f.of_mean},
                                         {"error_of_one", f.of_one}});
  return page;
}

}  // namespace luxel::bench
