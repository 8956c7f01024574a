#include "luxel/solve/hierarchical/irradiance.h"

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/surface_points.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"
#include "luxel/solve/hierarchical/light_mesh.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/viewfactor/rectangle_factor.h"
#include "tests/reference_data.h"

namespace luxel::hierarchical {
namespace {

using testing::solved;
using testing::Solved;

std::vector<Rgb> light_at(const Solved& s, std::span<const Receiver> receivers, double tolerance) {
  Progress progress;
  return *irradiance_at(s.solution, s.scene, *s.tracer, receivers, {tolerance}, progress);
}

/// B alone shines, with radiosity 1; nothing reflects.
scene::Scene unit_source(const TextRow& row) {
  scene::Scene scene;
  const uint32_t dark = scene::add_material(scene, "dark", {0, 0, 0});
  const float radiance = 1 / kPi;
  const uint32_t bright =
      scene::add_material(scene, "bright", {0, 0, 0}, {radiance, radiance, radiance});
  testing::add_polygon(scene, "B", testing_support::parse_polygon(row[3]), bright);
  if (row[1] == "poly")
    testing::add_polygon(scene, "A", testing_support::parse_polygon(row[2]), dark);
  for (const auto& blocker : testing_support::parse_polygons(row[4]))
    testing::add_polygon(scene, "blocker", blocker, dark);
  return scene;
}

TEST(ExactIrradiance, OfAUnitSourceIsThePointsFormFactor) {
  int rows = 0;
  for (const auto& row : testing_support::csv_rows("reference/view-factors.csv")) {
    if (row[1] != "point") continue;
    const auto s = solved(unit_source(row));
    const auto place = testing_support::parse_polygon(row[2]);
    const Receiver at{place[0], normalize(place[1]), normalize(place[1]), kNone, 1};
    const double wanted = std::stod(row[5]);
    // Corners are floats: 6e-8 of their size.
    EXPECT_NEAR(light_at(*s, {&at, 1}, 1e-9)[0].x, wanted, 1e-6 * wanted) << row[0];
    ++rows;
  }
  EXPECT_GT(rows, 4);
}

/// Nodes and weights on [0, 1] that cluster at both ends, for functions with kinks there:
/// x = (1 + tanh(pi/2 sinh u)) / 2 in steps of u. [Takahasi74]
std::vector<std::array<double, 2>> tanh_sinh(int half) {
  std::vector<std::array<double, 2>> out;
  const double step = 3.2 / half;
  for (int k = -half; k <= half; ++k) {
    const double u = k * step, a = M_PI / 2 * std::sinh(u);
    out.push_back(
        {0.5 * (1 + std::tanh(a)), step * M_PI / 4 * std::cosh(u) / (std::cosh(a) * std::cosh(a))});
  }
  return out;
}

/// The mean over a parallelogram or a triangle of what its points see, cell by cell of a grid.
double mean_light(const Solved& s, const Polygon& a, int cells, int half) {
  const Plane plane = viewfactor::plane_of(a);
  const DVec3 e1 = a[1] - a[0], e2 = a.back() - a[0];
  std::vector<Receiver> receivers;
  std::vector<double> weight;
  const auto nodes = tanh_sinh(half);
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (const auto& [x, wx] : nodes)
        for (const auto& [y, wy] : nodes) {
          const double u = (i + x) / cells, v = (j + y) / cells;
          const bool triangle = a.size() == 3;
          receivers.push_back(
              {a[0] + e1 * (triangle ? u * (1 - v) : u) + e2 * (triangle ? u * v : v), plane.normal,
               plane.normal, kNone, 1});
          weight.push_back(wx * wy / (cells * cells) * (triangle ? 2 * u : 1));
        }
  const std::vector<Rgb> e = light_at(s, receivers, 1e-9);
  double sum = 0;
  for (size_t k = 0; k < e.size(); ++k) sum += weight[k] * double(e[k].x);
  return sum;
}

/// E of a face, triangle by triangle of a mesh along all discontinuities.
double mean_light_along_lines(const Solved& s, uint32_t face) {
  MeshParams params;
  params.discontinuity.least_weight = 0, params.discontinuity.least_light = 0;
  params.discontinuity.max_per_leaf = 100000;
  params.point.tolerance = 1;  // its own light is not asked for
  Progress progress;
  const LightMesh mesh = *make_light_mesh(s.solution, s.scene, *s.tracer, params, progress);
  double sum = 0, area = 0;
  for (const LightTriangle& t : mesh.triangles) {
    if (t.face != face) continue;
    const Polygon p{mesh.vertices[t.vertex[0]], mesh.vertices[t.vertex[1]],
                    mesh.vertices[t.vertex[2]]};
    const double size = viewfactor::area_m2(p);
    sum += size * mean_light(s, p, 1, 8), area += size;
  }
  return sum / area;
}

// Past blockers the light over A has kinks, which a product rule does not see. They are
// discontinuities: between them light is smooth. Without EV lines, say, means are off by more
// than 1e-5.
TEST(ExactIrradiance, OfAUnitSourceMeansTheViewFactor) {
  int rows = 0;
  for (const auto& row : testing_support::csv_rows("reference/view-factors.csv")) {
    if (row[1] != "poly") continue;
    const auto s = solved(unit_source(row));
    const auto a = testing_support::parse_polygon(row[2]);
    const double wanted = std::stod(row[5]);
    if (row[4].empty()) {
      EXPECT_NEAR(mean_light(*s, a, 2, 20), wanted, 1e-6 * wanted + 1e-9) << row[0];
    } else {
      const uint32_t face = s->solution.faces.face_of_triangle[s->solution.faces.first_triangle[1]];
      EXPECT_NEAR(mean_light_along_lines(*s, face), wanted, 1e-5 * wanted) << row[0];
    }
    ++rows;
  }
  EXPECT_GT(rows, 30);
}

/// E by rays in strata over the hemisphere, each bringing the radiosity of what it meets, linear
/// over its leaf; and the standard error.
struct Estimate {
  double mean = 0, standard_error = 0;
};
Estimate estimate(const Solved& s, const Receiver& at, uint32_t samples) {
  const Solution& solution = s.solution;
  const auto frame = frame_around(to_float(at.normal));
  const Vec3 from = at.start();
  RandomStream random{hash64(uint64_t(1e6 * at.position.x), uint64_t(1e6 * at.position.z))};
  double sum = 0, sum2 = 0;
  for (uint32_t k = 0; k < samples; ++k) {
    const trace::Hit hit = s.tracer->closest_hit(
        {from, 0, frame.to_world(cosine_hemisphere_sample(random.next2())), INFINITY});
    if (!hit.found() || hit.back_face) continue;
    const FacePoint place = face_point_of(s.scene, solution.faces, hit.point());
    const size_t leaf = leaf_at(solution.tree, solution.faces, place.face, place.position);
    const Element& e = solution.tree.elements[leaf];
    const auto& b = solution.light.elements[leaf].shining;
    const auto [u, v] = place_in(e, place.position);
    const double value = double(linear_at(b, e.corners, float(u), float(v)).y);
    sum += value, sum2 += value * value;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt((sum2 / samples - mean * mean) / samples)};
}

// Twenty points of the box, shadows of the blocks and corners among them: independent of every
// closed form. Of 20 draws one is beyond 3.5 standard errors in one of 100 runs; the seed is fixed.
// The tolerance of sources is below a tenth of the rays' error.
TEST(ExactIrradiance, IsWhatRaysFind) {
  const auto s = solved(scene::cornell_box(), {.eps = 0.05});
  std::vector<Receiver> receivers;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(s->scene, 20, 11)) {
    const FacePoint place = face_point_of(s->scene, s->solution.faces, p);
    receivers.push_back(receiver_at(s->solution, s->scene, *s->tracer, place.face, place.position));
  }
  const std::vector<Rgb> exact = light_at(*s, receivers, 1e-5);
  for (size_t k = 0; k < exact.size(); ++k) {
    const Estimate rays = estimate(*s, receivers[k], 200000);
    EXPECT_NEAR(exact[k].y, rays.mean, 3.5 * rays.standard_error + 1e-5) << k;
  }
}

TEST(ExactIrradiance, SourcesAddUp) {
  const auto s = solved(scene::cornell_box(), {.eps = 0.05});
  const Receiver at = receiver_at(s->solution, s->scene, *s->tracer,
                                  s->solution.faces.face_of_triangle[0], {0.1, 0, 0.3});
  const std::vector<Seen> seen = sources_at(s->solution, *s->tracer, at, {1e-5});
  Rgb sum{};
  double covered = 0;
  for (const Seen& f : seen) {
    sum += f.irradiance, covered += f.visible;
    EXPECT_LE(f.visible, f.whole + 1e-9);
  }
  const std::vector<Rgb> e = light_at(*s, {&at, 1}, 1e-5);
  EXPECT_NEAR(sum.x, e[0].x, 1e-3 * e[0].x);
  EXPECT_LE(covered, 1 + 1e-9);
  ASSERT_GT(seen.size(), 3u);
  EXPECT_GE(luminance(seen[0].irradiance), luminance(seen[1].irradiance));
}

// More lamps than are looked at, in one place: 300 I / d^2 on a floor under them. All were left
// out.
TEST(ExactIrradiance, CountsManyLamps) {
  scene::Scene scene;
  const uint32_t dark = scene::add_material(scene, "dark", {0, 0, 0});
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, dark);
  scene::PunctualLight lamp;
  lamp.position = {0, 2, 0}, lamp.intensity = {1, 2, 3};
  scene.lights.assign(300, lamp);
  const Receiver at{{0, 0, 0}, {0, 1, 0}, {0, 1, 0}, kNone, 1};
  const auto s = solved(scene);
  // 64 of them stand for all, evenly drawn: they may count one too many or too few.
  EXPECT_NEAR(light_at(*s, {&at, 1}, 1e-6)[0].y, 300 * 2 / 4.0, 150 / 64.0);
  Progress progress;
  EXPECT_NEAR((*sharp_irradiance_at(scene, *s->tracer, {&at, 1}, progress))[0].y, 150, 150 / 64.0);
}

// An open plate under the sky: pi L; a wall beside it hides its share.
TEST(ExactIrradiance, CountsTheSky) {
  scene::Scene scene;
  const uint32_t dark = scene::add_material(scene, "dark", {0, 0, 0});
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, dark);
  scene.background = {1, 2, 3};
  const Receiver at{{0, 1e-3, 0}, {0, 1, 0}, {0, 1, 0}};
  EXPECT_NEAR(light_at(*solved(scene), {&at, 1}, 1e-6)[0].y, 2 * kPi, 1e-5);
  // A wall of infinite height at x = 0 hides half the sky of a point at its foot.
  testing::add_polygon(scene, "wall",
                       {{0.001, -1, -1e4}, {0.001, -1, 1e4}, {0.001, 2e4, 1e4}, {0.001, 2e4, -1e4}},
                       dark);
  EXPECT_NEAR(light_at(*solved(scene), {&at, 1}, 1e-6)[0].y, kPi, 1e-3);
}

/// A black sheet 1 m above y = 0, masked by alphas at its corners that grow along x: of [-1, 1] the
/// half [0, 1] is there.
scene::Scene half_a_sheet(Rgb emission) {
  scene::Scene scene;
  const uint32_t sheet = scene::add_material(scene, "sheet", {0, 0, 0}, emission);
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 1, false, sheet);
  scene.materials[sheet].alpha_mode = scene::AlphaMode::mask;
  for (const Vec3& p : scene.meshes[0].positions)
    scene.meshes[0].alphas.push_back(0.5f + 0.5f * p.x);
  return scene;
}

// 8,192 rays meet the mask's straight borders to a thousandth: n^-3/4 of half the light.
TEST(ExactIrradiance, TheSkyComesThroughAMask) {
  scene::Scene scene = half_a_sheet({});
  scene.background = {1, 2, 3};
  const auto s = solved(scene);
  for (const double x : {-0.8, 0.2, 0.9}) {
    const Receiver at{{x, 0, 0.1}, {0, 1, 0}, {0, 1, 0}};
    const double hidden = viewfactor::rectangle_factor(-x, 1 - x, -1.1, 0.9, 1);
    const Rgb e = light_at(*s, {&at, 1}, 1e-6)[0];
    EXPECT_NEAR(e.x, kPiDouble * (1 - hidden), 3e-3 * kPiDouble) << x;
    EXPECT_NEAR(e.z, 3 * e.x, 1e-4) << x;
  }
}

// Only the half that is there emits: the sheet's elements have the mean over what they hold.
TEST(ExactIrradiance, HolesOfVertexAlphaSendNothing) {
  const auto s = solved(half_a_sheet({1, 1, 1}));
  const Receiver at{{0, -9, 0}, {0, 1, 0}, {0, 1, 0}};
  const double all = viewfactor::rectangle_factor(-1, 1, -1, 1, 10);
  EXPECT_NEAR(light_at(*s, {&at, 1}, 1e-6)[0].x, kPiDouble * all / 2, 0.02 * kPiDouble * all);
}

}  // namespace
}  // namespace luxel::hierarchical
