#include "luxel/solve/hierarchical/represent.h"

#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"
#include "luxel/solve/hierarchical/surface.h"

namespace luxel::hierarchical {
namespace {

using testing::solved;
using testing::Solved;

LightMesh represented(Solved& s, const RepresentParams& params = {}) {
  Progress progress;
  auto mesh = represent(s.solution, s.scene, *s.tracer, {}, params, progress);
  EXPECT_TRUE(mesh);
  return std::move(*mesh);
}

/// E of the first face, whose plane is y = 0.
double floor_light(const Solved& s, const LightMesh& mesh, double x, double z) {
  const uint32_t floor = s.solution.faces.face_of_triangle[0];
  const MeshPoint at = *locate(s.solution, mesh, floor, {x, 0, z});
  return double(value_of(mesh.interpolant[at.triangle], at.s, at.t).x);
}

/// A floor of 4 m under a lamp of 100 W/sr, 1 m above its middle: E = 100 / (1 + r^2)^(3/2).
scene::Scene lamp_over_floor() {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, gray);
  scene::PunctualLight lamp;
  lamp.position = {0, 1, 0};
  lamp.intensity = {100, 100, 100};
  scene.lights.push_back(lamp);
  return scene;
}

// Progress knows the time that is left when the last mesh is made, and that of those after it. The
// meshes themselves take a moment.
TEST(Represent, TellsWhatIsToCome) {
  const auto s = solved(lamp_over_floor());
  Progress progress;
  progress.expect_at_end({{"write", 1000}});
  RepresentParams params;
  params.later_seconds = 5000;
  ASSERT_TRUE(represent(s->solution, s->scene, *s->tracer, {}, params, progress));
  EXPECT_NEAR(progress.snapshot().seconds_left, 6000, 100);
}

/// The root of the mean square difference to the closed form.
double error_below(const Solved& s, const LightMesh& mesh) {
  constexpr int n = 160;
  double squares = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = 4 * (i + 0.5) / n - 2, z = 4 * (j + 0.5) / n - 2;
      const double d = floor_light(s, mesh, x, z) - 100 * std::pow(1 + x * x + z * z, -1.5);
      squares += d * d;
    }
  return std::sqrt(squares) / n;
}

// Links and leaves' linear light allow 40 W/m^2; interpolants keep what is asked of them. The floor
// is the only face, so its area is the unit: errors of all elements together are eps times the root
// of their number at most.
TEST(Represent, DividesUntilInterpolantsHold) {
  double before = INFINITY;
  size_t triangles = 0;
  for (const double eps : {4.0, 0.5, 0.05}) {
    const auto s = solved(lamp_over_floor(), {.eps = 40});
    const LightMesh mesh = represented(*s, {.eps = eps});
    const double error = error_below(*s, mesh);
    EXPECT_LT(error, eps * std::sqrt(double(testing::leaf_count(s->solution.tree)))) << eps;
    EXPECT_LT(error, 0.5 * before);
    EXPECT_GT(mesh.triangles.size(), triangles);
    before = error, triangles = mesh.triangles.size();
  }
}

// A closed room absorbs what its lamp emits.
TEST(Represent, KeepsEnergy) {
  for (const auto& eps : {std::optional<double>(), std::optional<double>(0.02)}) {
    const auto s = solved(scene::radiosity_box(), {.eps = eps});
    (void)represented(*s);
    // A quarter of a hundredth is what interpolants may be off by.
    EXPECT_NEAR(absorbed_over_emitted(s->solution), 1, 0.004);
  }
}

TEST(Represent, EndsAtItsBounds) {
  const auto s = solved(lamp_over_floor(), {.eps = 40});
  const size_t elements = s->solution.tree.elements.size();
  (void)represented(*s, {.eps = 0.0, .max_rounds = 0});
  EXPECT_EQ(s->solution.tree.elements.size(), elements);
  (void)represented(*s, {.eps = 0.0, .max_elements = elements + 8});
  EXPECT_LE(s->solution.tree.elements.size(), elements + 8);
}

// Without time the first mesh is not refined, and that is said.
TEST(Represent, SaysWhatItHadNoTimeFor) {
  const auto s = solved(lamp_over_floor(), {.eps = 40});
  Progress progress;
  LeftOut left_out;
  const auto coarse = represent(s->solution, s->scene, *s->tracer, {}, {.eps = 0.05, .seconds = 0},
                                progress, &left_out);
  ASSERT_TRUE(coarse);
  EXPECT_TRUE(left_out.refinement);
  EXPECT_GT(coarse->triangles.size(), 0u);
  const LightMesh fine = represented(*s, {.eps = 0.05});
  EXPECT_GT(fine.triangles.size(), coarse->triangles.size());
}

// The shadow of a screen's edge at x = 0.25 m, 1 m above the floor. A lamp 2.5 m up throws it to
// 0.25 / (1 - 1 / 2.5) = 0.41667 m; a sun that shines along (1, -2, 0) to 0.75 m. Half a millimetre
// beside it there is all of the light, or none.
TEST(Represent, ShadowsOfSharpLampsJump) {
  for (const bool sun : {false, true}) {
    scene::Scene scene;
    const uint32_t black = scene::add_material(scene, "black", {0, 0, 0});
    scene::add_rectangle(scene, {-2.5f, 2.5f, -2.5f, 2.5f}, 0, true, black);
    scene::add_rectangle(scene, {-1.5f, 0.25f, -1, 1}, 1, true, black);
    scene::PunctualLight lamp;
    lamp.position = {0, 2.5f, 0};
    lamp.intensity = {50, 50, 50};
    if (sun) {
      lamp.kind = scene::PunctualLight::Kind::directional;
      lamp.direction = normalize(Vec3{1, -2, 0});
      lamp.intensity = {10, 10, 10};
    }
    scene.lights.push_back(lamp);
    const auto s = solved(std::move(scene), {.eps = 1});
    const LightMesh mesh = represented(*s);
    const double edge = sun ? 0.75 : 0.25 / (1 - 1 / 2.5);
    const double whole = sun ? 10 * 2 / std::sqrt(5.0)
                             : 50 * 2.5 * std::pow(edge * edge + 0.1 * 0.1 + 2.5 * 2.5, -1.5);
    EXPECT_NEAR(floor_light(*s, mesh, edge - 5e-4, 0.1), 0, 0.01 * whole) << sun;
    EXPECT_NEAR(floor_light(*s, mesh, edge + 5e-4, 0.1), whole, 0.01 * whole) << sun;
  }
}

TEST(Represent, SameBitsForAnyNumberOfThreads) {
  std::vector<LightMesh> meshes;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const auto s = solved(scene::cornell_box(), {.eps = 0.05});
    meshes.push_back(represented(*s));
  }
  ASSERT_EQ(meshes[0].triangles.size(), meshes[1].triangles.size());
  for (size_t t = 0; t < meshes[0].triangles.size(); ++t)
    EXPECT_EQ(meshes[0].interpolant[t], meshes[1].interpolant[t]) << t;
}

// In a furnace light that has been reflected no more than n times is e (1 + rho + ... + rho^n):
// points gather what was reflected n - 1 times.
TEST(Represent, CountsBounces) {
  for (const int n : {0, 1, 3}) {
    const auto s = solved(scene::furnace_box({0.5f, 0.5f, 0.5f}, Rgb{1, 1, 1} * (1 / kPi)),
                          {.eps = 0.02, .bounces = n});
    const LightMesh mesh = represented(*s);
    const double wanted = 2 * (1 - std::pow(0.5, n + 1));
    for (const Interpolant& r : mesh.interpolant)
      EXPECT_NEAR(double(value_of(r, 0.3f, 0.3f).x), wanted, 0.005 * wanted) << n;
  }
}

}  // namespace
}  // namespace luxel::hierarchical
