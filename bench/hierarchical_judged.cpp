// Judges of the hierarchical solution: paths, rays, and the conservation of energy.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/hierarchical.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/surface_points.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/validate/agreement.h"

namespace luxel::bench {
namespace {

namespace h = luxel::hierarchical;

constexpr int kJudgePaths = 1024;
constexpr int kLightmap = 96;  ///< texels a side
constexpr int kPictureWidth = 160, kPictureHeight = 120;
constexpr size_t kJudgedPoints = 200;
constexpr uint32_t kRays = 1'000'000;

std::vector<std::string> agreement_row(std::string scene, std::string what,
                                       const validate::Agreement& a, double seconds) {
  return {std::move(scene),
          std::move(what),
          fmt::format("{}", a.texels),
          validate::relative_rmse_text(a),
          fmt::format("{:.2f} %", 100 * a.resolution),
          fmt::format("{:+.2f} %", 100 * a.bias_over_mean),
          fmt::format("{:.1f}", seconds)};
}

Result<std::vector<std::string>> lightmap_row(std::string name, scene::Scene scene,
                                              std::optional<double> eps, Progress& progress) {
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), kLightmap, progress));
  LUXEL_TRY(const validate::Judged judged, validate::judge(*p, kJudgePaths, 1, progress));
  pipeline::BakeSettings settings;
  settings.own.of<pipeline::HierarchicalSettings>().solve.eps = eps;
  LUXEL_TRY(const validate::Timed solved, validate::solve(*p, "hierarchical", settings, progress));
  return agreement_row(std::move(name), "lightmap",
                       validate::agreement(solved.light.irradiance, solved.light.hidden, judged),
                       solved.seconds);
}

/// Agreement of a camera's picture with paths: light where the rays through pixels' middles end.
Result<std::vector<std::string>> picture_row(std::string name, const scene::Scene& scene,
                                             std::optional<double> eps, Progress& progress) {
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const auto start = Clock::now();
  h::SolveParams params;
  params.eps = eps;
  LUXEL_TRY(h::Solution solution, h::solve(scene, tracer, params, progress));
  LUXEL_TRY(const h::LightMesh mesh, h::represent(solution, scene, tracer, {}, {}, progress));
  const double seconds = seconds_since(start);
  const trace::CameraRays camera(scene.cameras.front(), kPictureWidth, kPictureHeight);
  std::vector<trace::Ray> rays;
  for (int y = 0; y < kPictureHeight; ++y)
    for (int x = 0; x < kPictureWidth; ++x)
      rays.push_back(camera.through(float(x) + 0.5f, float(y) + 0.5f));
  std::vector<Vec3> position, normal;
  std::vector<Rgb> solved;
  for (const trace::Hit& hit : trace::visible_hits(scene, tracer, rays)) {
    if (!hit.found()) continue;
    normal.push_back(scene::front_normal(scene, hit.instance, hit.triangle));
    position.push_back(scene::off_surface(scene, hit.point(), normal.back()));
    solved.push_back(h::irradiance_at(solution, mesh, scene, hit.point()));
  }
  LUXEL_TRY(const validate::Judged judged,
            validate::judge(scene, tracer, {position, normal, normal}, kJudgePaths, 1, progress));
  return agreement_row(std::move(name), "picture", validate::agreement(solved, {}, judged),
                       seconds);
}

Result<Table> path_table(Progress& progress) {
  Table t = new_table("hierarchical: against the path tracer",
                      {"scene", "as", "places", "relative RMSE", "told from", "bias", "s"});
  for (const auto& [name, scene, eps] :
       {std::tuple{"office", scene::office(), std::optional<double>(0.1)},
        std::tuple{"Cornell box", scene::cornell_box(), std::optional<double>()}}) {
    LUXEL_TRY(auto lightmap, lightmap_row(name, scene, eps, progress));
    LUXEL_TRY(auto picture, picture_row(name, scene, eps, progress));
    t.rows.push_back(std::move(lightmap)), t.rows.push_back(std::move(picture));
  }
  t.notes.push_back(
      fmt::format("Office at eps 0.1, Cornell box at the default. Lightmaps of {0} x {0}; pictures "
                  "of {1} x {2}, "
                  "light at the middles of pixels; twice {3} paths at each place, whose noise is "
                  "taken out. The "
                  "goal: below 2 %. s: the solver.",
                  kLightmap, kPictureWidth, kPictureHeight, kJudgePaths));
  return t;
}

/// Difference between exact light and the mean of rays that meet the same radiosity, in standard
/// errors of that mean.
double standard_errors_off(const h::Solution& s, const scene::Scene& scene,
                           const trace::RayTracer& tracer, const h::Receiver& at, Rgb exact,
                           uint64_t seed) {
  const auto frame = frame_around(to_float(at.normal));
  const Vec3 from = at.start();
  RandomStream random{seed};
  double sum = 0, squares = 0;
  for (uint32_t k = 0; k < kRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(random.next2()));
    const trace::Hit hit = tracer.closest_hit({from, 0, d, INFINITY});
    if (!hit.found() || hit.back_face) continue;
    const h::FacePoint place = h::face_point_of(scene, s.faces, hit.point());
    if (place.face == h::kNone) continue;
    const size_t leaf = h::leaf_at(s.tree, s.faces, place.face, place.position);
    const h::Element& e = s.tree.elements[leaf];
    const auto [u, v] = h::place_in(e, place.position);
    const double value = double(
        luminance(h::linear_at(s.light.elements[leaf].shining, e.corners, float(u), float(v))));
    sum += value, squares += value * value;
  }
  const double mean = sum / kRays;
  const double error = std::sqrt((squares / kRays - mean * mean) / kRays);
  return error > 0 ? (double(luminance(exact)) - mean) / error : 0;
}

Result<Table> rays_table(Progress& progress) {
  const scene::Scene scene = scene::office();
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  h::SolveParams params;
  params.eps = 0.1;
  LUXEL_TRY(const h::Solution s, h::solve(scene, tracer, params, progress));
  // Exact light at random points, and how many standard errors of many rays it is off.
  std::vector<h::Receiver> receivers;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(scene, kJudgedPoints, 17)) {
    const h::FacePoint place = h::face_point_of(scene, s.faces, p);
    receivers.push_back(h::receiver_at(s, scene, tracer, place.face, place.position));
  }
  LUXEL_TRY(const std::vector<Rgb> exact,
            h::irradiance_at(s, scene, tracer, receivers, {.tolerance = 1e-6}, progress));
  std::vector<double> off(receivers.size());
  parallel_for(receivers.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      off[k] = standard_errors_off(s, scene, tracer, receivers[k], exact[k], hash64(k, 3));
  });
  // A normal law has a root mean square of 1.
  double squares = 0, within_one = 0, within_two = 0, worst = 0;
  for (const double z : off) {
    squares += z * z / double(off.size());
    within_one += (std::abs(z) < 1) / double(off.size());
    within_two += (std::abs(z) < 2) / double(off.size());
    worst = std::max(worst, std::abs(z));
  }
  Table t = new_table("hierarchical: exact light against rays",
                      {"", "root mean square", "within one", "within two", "most"});
  t.rows = {{"measured", fmt::format("{:.2f}", std::sqrt(squares)),
             fmt::format("{:.0f} %", 100 * within_one), fmt::format("{:.0f} %", 100 * within_two),
             fmt::format("{:.2f}", worst)},
            {"of a normal law", "1", "68 %", "95 %", "2.8 expected"}};
  t.notes.push_back(
      fmt::format("Differences at {} random points of the office in standard errors of {} rays, "
                  "each of which brings the solution's radiosity where it ends.",
                  kJudgedPoints, kRays));
  return t;
}

/// Absorbed over emitted in closed rooms, by what light may be over elements.
Result<Table> energy_table(Progress& progress) {
  Table t =
      new_table("hierarchical: energy", {"scene", "eps", "links", "constant", "linear on receivers",
                                         "linear", "linear, exact light fed back"});
  for (const auto& [name, scene, eps] : {std::tuple{"box", scene::radiosity_box(), 0.1},
                                         std::tuple{"box", scene::radiosity_box(), 0.02},
                                         std::tuple{"box", scene::radiosity_box(), 0.005},
                                         std::tuple{"office", scene::office(), 0.1}}) {
    LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
    std::vector<std::string> row{name, fmt::format("{}", eps), ""};
    // All three function spaces; the last with exact light fed back, too.
    for (const auto basis : {h::Basis::constant, h::Basis::linear_receivers, h::Basis::linear}) {
      h::SolveParams params;
      params.eps = eps, params.basis = basis;
      LUXEL_TRY(h::Solution s, h::solve(scene, tracer, params, progress));
      row[2] += fmt::format("{}{}", row[2].empty() ? "" : " / ", s.links.count);
      row.push_back(fmt::format("{:.4f}", h::absorbed_over_emitted(s)));
      if (basis != h::Basis::linear) continue;
      LUXEL_TRY(const h::LightMesh mesh, h::represent(s, scene, tracer, {}, {}, progress));
      row.push_back(fmt::format("{:.4f}", h::absorbed_over_emitted(s)));
    }
    t.rows.push_back(std::move(row));
  }
  t.notes.push_back(
      "Absorbed over emitted light; by the functions that light may be over elements. Box: the "
      "closed one of docs/method/hemicube.md, its lamp beside the ceiling. The goal: within 1 %.");
  return t;
}

}  // namespace

Result<std::vector<Table>> hierarchical_judged(Progress& progress) {
  std::vector<Table> out;
  LUXEL_TRY(Table energy, energy_table(progress));
  LUXEL_TRY(Table rays, rays_table(progress));
  LUXEL_TRY(Table paths, path_table(progress));
  out.push_back(std::move(energy)), out.push_back(std::move(rays)), out.push_back(std::move(paths));
  return out;
}

}  // namespace luxel::bench
