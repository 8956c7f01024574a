#include "bench/hierarchical.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/timing.h"
#include "luxel/pipeline/render/draw_hierarchical.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/surface_points.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

namespace h = luxel::hierarchical;

/// [Hardt96, section 7.1]
constexpr double kPaperEps = 0.1, kPaperSolution_s = 120, kPaperInterpolants_s = 9000,
                 kPaperFrames = 2.3;
constexpr size_t kPoints = 100000;

/// A scene, solved and meshed. Stays where it was made.
struct Run {
  scene::Scene scene;
  std::optional<trace::RayTracer> tracer;
  h::Solution solution;
  h::LightMesh mesh;
  double solve_s = 0, mesh_s = 0;  ///< of the processor
};

Result<std::unique_ptr<Run>> run(scene::Scene scene, std::optional<double> eps,
                                 Progress& progress) {
  auto out = std::make_unique<Run>();
  out->scene = std::move(scene);
  const std::clock_t start = std::clock();
  LUXEL_TRY(out->tracer, trace::RayTracer::build(out->scene));
  h::SolveParams params;
  params.eps = eps;
  LUXEL_TRY(out->solution, h::solve(out->scene, *out->tracer, params, progress));
  out->solve_s = processor_seconds_since(start);
  const std::clock_t begin_mesh = std::clock();
  LUXEL_TRY(out->mesh, h::represent(out->solution, out->scene, *out->tracer, {}, {}, progress));
  out->mesh_s = processor_seconds_since(begin_mesh);
  return out;
}

size_t leaves_of(const h::Tree& tree) {
  return size_t(std::count_if(tree.elements.begin(), tree.elements.end(),
                              [](const h::Element& e) { return e.is_leaf(); }));
}

Result<Table> office_table(const Run& r) {
  LUXEL_TRY(const display::QuadraticView view,
            display::QuadraticView::make(pipeline::quadratic_mesh(r.scene, r.solution, r.mesh)));
  const std::vector<double> ms =
      time_in_turn({[&] { (void)view.draw(r.scene.cameras.front(), 640, 480); },
                    [&] { (void)view.draw(r.scene.cameras.front(), 960, 720); }},
                   30);
  Table t = new_table("hierarchical: the office", {"", "luxel", "paper", "goal"});
  t.rows = {
      {"eps, W/m^2", fmt::format("{}", kPaperEps), fmt::format("{}", kPaperEps), ""},
      {"elements (leaves)", fmt::format("{}", leaves_of(r.solution.tree)), "1622", "about 1600"},
      {"links", fmt::format("{}", r.solution.links.count), "", ""},
      {"triangles", fmt::format("{}", r.mesh.triangles.size()), "6576", "about 6500"},
      {"solution, s", fmt::format("{:.2f}", r.solve_s), fmt::format("{:.0f}", kPaperSolution_s),
       "2"},
      {"interpolants, s", fmt::format("{:.2f}", r.mesh_s),
       fmt::format("{:.0f}", kPaperInterpolants_s), "15"},
      {"points with exact light", fmt::format("{}", r.mesh.samples), "", ""},
      {"640 x 480 pictures per second", fmt::format("{:.1f}", 1000 / ms[0]),
       fmt::format("{}", kPaperFrames), "30"},
      {"960 x 720 picture, ms", fmt::format("{:.1f}", ms[1]), "", "20"}};
  t.notes.push_back(
      "Processor seconds. Interpolants: discontinuities, triangulation and exact light. Pictures: "
      "the "
      "median of 30.");
  return t;
}

/// Interpolated against exact light.
Result<Table> exact_table(const Run& r, Progress& progress) {
  // Exact light at random points.
  std::vector<h::Receiver> receivers;
  std::vector<scene::SurfacePoint> points;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(r.scene, kPoints, 5)) {
    const h::FacePoint place = h::face_point_of(r.scene, r.solution.faces, p);
    if (place.face == h::kNone) continue;
    points.push_back(p);
    receivers.push_back(h::receiver_at(r.solution, r.scene, *r.tracer, place.face, place.position));
  }
  LUXEL_TRY(const std::vector<Rgb> exact,
            h::irradiance_at(r.solution, r.scene, *r.tracer, receivers, {}, progress));
  double mean = 0;
  for (const Rgb& e : exact) mean += double(luminance(e)) / double(exact.size());
  // Relative errors of the interpolants there, by rank.
  std::vector<double> error;
  for (size_t k = 0; k < exact.size(); ++k) {
    const double e = double(luminance(exact[k]));
    if (e < 1e-3 * mean) continue;  // inside of furniture, where all is dark
    const double i = double(luminance(h::irradiance_at(r.solution, r.mesh, r.scene, points[k])));
    error.push_back(std::abs(i - e) / e);
  }
  std::sort(error.begin(), error.end());
  const auto at = [&](double q) {
    return fmt::format("{:.3f} %", 100 * error[size_t(q * double(error.size() - 1))]);
  };
  Table t = new_table("hierarchical: interpolants against exact light",
                      {"points", "median", "90 %", "95 %", "99 %"});
  t.rows = {{fmt::format("{}", error.size()), at(0.5), at(0.9), at(0.95), at(0.99)}};
  t.notes.push_back(
      "Relative errors at random points of the office; points with less than a thousandth of the "
      "mean light are left out. Goals: 0.5 % and, for 95 %, 3 %.");
  return t;
}

Result<Table> growth_table(Progress& progress) {
  Table t = new_table("hierarchical: growth",
                      {"cells", "triangles", "faces", "leaves", "links", "links per triangle", "s",
                       "ms per triangle", "links, MiB"});
  for (const int n : {4, 6, 11, 19, 35}) {
    const scene::Scene scene = open_plan_office(n);
    LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
    const std::clock_t start = std::clock();
    h::SolveParams params;
    params.eps = 2;
    LUXEL_TRY(const h::Solution s, h::solve(scene, tracer, params, progress));
    const double seconds = processor_seconds_since(start);
    const double triangles = double(scene::first_triangles(scene).back());
    // Memory of the links, with their lists of blockers.
    uint64_t bytes = 0;
    for (const auto& links : s.links.of)
      for (const h::Link& link : links) bytes += sizeof(link) + 4 * link.blockers.capacity();
    t.rows.push_back(
        {fmt::format("{}", n * n), fmt::format("{}", triangles), fmt::format("{}", s.faces.size()),
         fmt::format("{}", leaves_of(s.tree)), fmt::format("{}", s.links.count),
         fmt::format("{:.1f}", double(s.links.count) / triangles), fmt::format("{:.2f}", seconds),
         fmt::format("{:.3f}", 1e3 * seconds / triangles), fmt::format("{}", bytes >> 20)});
  }
  t.notes.push_back(
      "Cells of 3 m with a desk, a chair and a lamp in one hall; eps 2 W/m^2; processor seconds. "
      "The "
      "goal: time and links per triangle at most double.");
  return t;
}

/// A table's rows, its name in front of each; cells are quoted, for some hold commas.
std::string csv_of(const Table& t) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    text += t.name.substr(t.name.find(": ") + 2);
    for (const std::string& cell : cells) text += ",\"" + cell + "\"";
    text += "\n";
  };
  add(t.columns);
  for (const auto& row : t.rows) add(row);
  return text;
}

}  // namespace

scene::Scene open_plan_office(int n) {
  scene::Scene scene;
  scene.name = "open plan";
  const uint32_t gray = scene::add_material(scene, "gray", {0.6f, 0.6f, 0.6f});
  const uint32_t wood = scene::add_material(scene, "wood", {0.5f, 0.35f, 0.2f});
  const uint32_t light = scene::add_material(scene, "light", {0, 0, 0}, {60, 60, 55});
  constexpr float cell = 3, height = 2.8f;
  const float side = cell * float(n);
  scene::Mesh hall;
  hall.name = "hall";
  scene::add_box(hall, {0, 0, 0}, {side, height, side}, gray);
  for (auto& t : hall.triangles) std::swap(t[1], t[2]);  // seen from inside
  scene::place(scene, std::move(hall));
  // Cells with a light under the ceiling, a desk, a chair and a screen.
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3 at{cell * float(i), 0, cell * float(j)};
      scene::add_rectangle(scene, {at.x + 1, at.x + 2, at.z + 1.2f, at.z + 1.5f}, 2.7f, false,
                           light);
      scene::Mesh furniture;
      furniture.name = "furniture";
      const auto box = [&](Vec3 low, Vec3 high) {
        scene::add_box(furniture, at + low, at + high, wood);
      };
      box({0.6f, 0.71f, 0.8f}, {2.2f, 0.75f, 1.6f});
      box({0.7f, 0.01f, 0.9f}, {0.74f, 0.70f, 1.5f});
      box({2.06f, 0.01f, 0.9f}, {2.1f, 0.70f, 1.5f});
      box({1.2f, 0.42f, 1.8f}, {1.7f, 0.48f, 2.3f});
      box({1.2f, 0.55f, 2.25f}, {1.7f, 1.0f, 2.3f});
      box({1.4f, 0.01f, 2.0f}, {1.5f, 0.41f, 2.1f});
      box({1.1f, 0.8f, 0.9f}, {1.6f, 1.2f, 0.94f});
      scene::place(scene, std::move(furniture));
    }
  return scene;
}

Result<HierarchicalPage> measure_hierarchical(const std::filesystem::path&, Progress& progress) {
  HierarchicalPage page;
  LUXEL_TRY(const auto office, run(scene::office(), kPaperEps, progress));
  LUXEL_TRY(Table table, office_table(*office));
  page.tables.push_back(std::move(table));
  LUXEL_TRY(Table exact, exact_table(*office, progress));
  page.tables.push_back(std::move(exact));
  LUXEL_TRY(std::vector<Table> judged, hierarchical_judged(progress));
  for (Table& t : judged) page.tables.push_back(std::move(t));
  LUXEL_TRY(Table growth, growth_table(progress));
  page.tables.push_back(std::move(growth));
  for (const Table& t : page.tables) {
    page.csv += csv_of(t);
    page.json[t.name] = {{"columns", t.columns}, {"rows", t.rows}};
  }
  return page;
}

}  // namespace luxel::bench
