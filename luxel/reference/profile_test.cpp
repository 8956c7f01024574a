// Lamps with a measured distribution: the path tracer against the solvers' own evaluation.
#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/light/direct_light.h"
#include "luxel/reference/reference_test_support.h"

namespace luxel::reference {
namespace {

using namespace testing;

/// A lobe to one side: nothing about it is symmetric.
scene::LightProfile lopsided_profile() {
  scene::LightProfile p;
  for (int v = 0; v <= 180; v += 10) p.vertical_rad.push_back(float(v) * kPi / 180);
  for (int h = 0; h <= 360; h += 20) p.horizontal_rad.push_back(float(h) * kPi / 180);
  for (const float h : p.horizontal_rad)
    for (const float v : p.vertical_rad)
      p.candela.push_back(20 + 10 * std::cos(v) + 8 * std::sin(v) * std::sin(h + 0.4f));
  return p;
}

/// Two lamps, of which one leans, over a floor with a wall that throws a shadow.
scene::Scene lit_floor() {
  scene::Scene scene;
  scene::add_material(scene, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-3, 3, -3, 3}, 0, true, 0);
  scene::add_rectangle(scene, {0.5f, 1, -1, 1}, 0.7f, true, 0);
  scene.lights.resize(2);
  scene.lights[0].position = {0.3f, 1.5f, 0.2f}, scene.lights[0].direction = {0.3f, -1, 0.4f};
  scene.lights[0].intensity = {1, 0.5f, 0.25f};
  scene.lights[1].position = {-1, 2, -0.5f};
  for (size_t i : {0, 1}) scene::attach_profile(scene, i, lopsided_profile(), 1 + float(i));
  return scene;
}

// The path tracer picks one of the two lamps each time: noise. The solvers' direct light has none.
TEST(Profiles, DirectLightIsThatOfTheSolvers) {
  const scene::Scene scene = lit_floor();
  Points points;
  for (int i = 0; i < 64; ++i)
    points.add({0.5f * float(i % 8) - 1.76f, 0, 0.5f * float(i / 8) - 1.77f}, {0, 1, 0});
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  transport::Elements elements;
  elements.position.assign(points.position.begin(), points.position.end());
  elements.normal.assign(points.normal.begin(), points.normal.end());
  elements.geometric_normal = elements.normal;
  elements.reflectance.resize(points.size());
  Progress progress;
  const auto direct =
      light::direct_light(scene, elements, light::collect_lights(scene), *tracer, {1, 1}, progress);
  ASSERT_TRUE(direct);
  std::vector<double> expected;
  for (const Rgb& e : direct->irradiance) expected.push_back(double(e.x));
  // Two ways of rounding a dozen operations on floats.
  expect_unbiased(solve(scene, points, {.samples = 4000, .bounces = 0}), expected, 2e-6);
}

// A lamp inside a closed diffuse sphere: whatever its distribution, after all bounces the mean E is
// flux / area / (1 - rho). Its flux is that of the interpolated profile.
TEST(Profiles, AClosedSphereGetsTheFluxOfTheProfile) {
  scene::Scene scene;
  scene::add_material(scene, "wall", {0.5f, 0.5f, 0.5f});
  scene::Mesh ball = scene::sphere("ball", 1, 32, 16, 0);
  for (auto& t : ball.triangles) std::swap(t[1], t[2]);  // its inside is the front
  for (Vec3& n : ball.normals) n = -n;
  scene::place(scene, ball);
  scene.lights.resize(1);
  scene::attach_profile(scene, 0, lopsided_profile(), 1);
  const Points points = random_points(scene, 400, 3);
  const TexelPaths e = solve(scene, points, {.samples = 400, .bounces = -1});
  double mean = 0, squares = 0, area = 0;
  for (const Rgb& v : e.irradiance) mean += double(v.x) / double(points.size());
  for (const Rgb& v : e.irradiance)
    squares += (double(v.x) - mean) * (double(v.x) - mean) / double(points.size());
  for (uint32_t t = 0; t < scene.meshes[0].triangles.size(); ++t)
    area += double(scene::area_m2(scene::world_triangle(scene, 0, t)));
  const double flux = 4 * kPiDouble * scene::mean_candela(scene.profiles[0], kPiDouble);
  // 400 points of a function that varies over the sphere: three of their standard errors.
  EXPECT_NEAR(mean, flux / area / 0.5, 3 * std::sqrt(squares / double(points.size())));
}

}  // namespace
}  // namespace luxel::reference
