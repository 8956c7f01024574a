// Direct light in closed form: every kind of light, and the cases that sampling gets wrong easily.
#include <gtest/gtest.h>

#include "luxel/reference/reference_test_support.h"
#include "luxel/scene/procedural.h"
#include "tests/reference_data.h"

namespace luxel::reference {
namespace {

namespace shared = luxel::testing_support;
using namespace testing;
using Kind = scene::PunctualLight::Kind;

const PathParams kDirect{.samples = 2000, .bounces = 0};

Points one_point(Vec3 p, Vec3 n = {0, 1, 0}) {
  Points points;
  points.add(p, n);
  return points;
}

/// 100 points on the floor y = 0 around the origin, facing up.
Points floor_points() {
  Points points;
  for (int i = 0; i < 100; ++i)
    points.add({0.2f * float(i % 10) - 0.9f, 0, 0.2f * float(i / 10) - 0.9f}, {0, 1, 0});
  return points;
}

/// A square of 1 m at height 1, front down, that the texture fills.
void add_textured_lamp(scene::Scene& scene) {
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, false, 0);
  for (const Vec3& p : scene.meshes[0].positions)
    scene.meshes[0].uv0.push_back({p.x + 0.5f, p.z + 0.5f});
}

/// pi L F of a rectangle at height y, seen from floor_points().
std::vector<double> rectangle_light(const Points& points, double x0, double x1, double z0,
                                    double z1, double y, double radiance) {
  std::vector<double> e;
  for (const Vec3& p : points.position) {
    const double x = double(p.x), z = double(p.z);
    e.push_back(kPiDouble * radiance * rectangle_factor(x0 - x, x1 - x, z0 - z, z1 - z, y));
  }
  return e;
}

/// The exact factors at nine points of the Cornell box, past both blocks and in the empty box.
TEST(Lights, TheExactCornellProbes) {
  const auto rows =
      shared::markdown_rows("reference/cornell-box.md", "Exact direct light", "surface");
  ASSERT_EQ(rows.size(), 9u);
  for (const bool with_blocks : {false, true}) {
    const scene::Scene scene = scene::cornell_box(scene::CornellColors::pbrt, with_blocks);
    float radiance = 0;
    for (const scene::Material& m : scene.materials) radiance = std::max(radiance, m.emission.x);
    Points points;
    std::vector<double> exact;
    for (const auto& row : rows) {
      const std::string& cell = row[with_blocks ? 4 : 3];
      if (cell == "-") continue;
      points.add(shared::parse_vec3(row[1]) * 1e-3f, shared::parse_vec3(row[2]));
      exact.push_back(kPiDouble * double(radiance) * std::stod(cell));
    }
    // The lamp hangs as measured, to float precision in metres.
    expect_unbiased(solve(scene, points, {.samples = 50000, .bounces = 0}), exact, 1e-5);
  }
}

// Paths start at a receiver's points in turn: under a lamp 2 m up, I cos / d^2 is I / 4 below it
// and I / 8 sqrt(1/2) two metres beside it; three points of the second receiver take 0, 1, 2, 0,
// ...
TEST(Lights, AReceiverOfSeveralPointsHasTheirMean) {
  scene::Scene scene;
  scene::PunctualLight lamp;
  lamp.position = {0, 2, 0};
  lamp.intensity = gray(8);
  scene.lights.push_back(lamp);
  Points points;
  for (const float x : {0.0f, 0.0f, 2.0f, 2.0f}) points.add({x, 0, 0}, {0, 1, 0});
  const std::vector<uint32_t> first{0, 1, 4};
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  const auto result = irradiance_by_paths(
      scene, {points.position, points.normal, points.normal, first}, *tracer, {30, 0, 1}, progress);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->irradiance.size(), 2u);
  const float beside = 8 / 8.0f * std::sqrt(0.5f);
  EXPECT_NEAR(result->irradiance[0].x, 2.0f, 1e-5f);
  EXPECT_NEAR(result->irradiance[1].x, (2 + 2 * beside) / 3, 1e-5f);
}

// A lamp that is bright in one corner of its texture, at four times its mean.
TEST(Lights, ATexturedLampShinesWhereItIsBright) {
  scene::Scene scene;
  scene::add_material(scene, "lamp", {}, gray(2));
  scene::Texture texture;
  texture.width = texture.height = 2;
  texture.rgba.assign(16, 0);
  for (const size_t i : {3u, 7u, 11u, 15u}) texture.rgba[i] = 255;
  texture.rgba[0] = texture.rgba[1] = texture.rgba[2] = 255;  // (0, 0), the corner of low u and v
  scene.textures.push_back(texture);
  scene.materials[0].emission_texture = {.texture = 0, .filter = scene::Filter::nearest};
  add_textured_lamp(scene);
  const Points points = floor_points();
  expect_unbiased(solve(scene, points, kDirect), rectangle_light(points, -0.5, 0, -0.5, 0, 1, 2));
}

// One bright row of sixteen: what luxel/light/textured_lights_test.cpp asks of gather's direct
// light.
TEST(Lights, ABrightRowBringsWhatItsGeometryWould) {
  scene::Scene scene;
  scene::add_material(scene, "lamp", {}, gray(2));
  scene::Texture texture;
  texture.width = 1, texture.height = 16;
  texture.rgba.assign(64, 0);
  for (size_t k = 0; k < 4; ++k) texture.rgba[4 * 5 + k] = 255;
  scene.textures.push_back(texture);
  scene.materials[0].emission_texture = {.texture = 0, .filter = scene::Filter::nearest};
  add_textured_lamp(scene);
  const Points points = floor_points();
  expect_unbiased(solve(scene, points, {.samples = 8000, .bounces = 0}),
                  rectangle_light(points, -0.5, 0.5, 5.0 / 16 - 0.5, 6.0 / 16 - 0.5, 1, 2));
}

// The lamp of one bright corner with holes: what is cut out neither shines nor blocks.
TEST(Lights, AMaskedLampShinesFromItsSolidPart) {
  scene::Scene scene;
  scene::add_material(scene, "lamp", {}, gray(2));
  scene::Texture texture;
  texture.width = 2, texture.height = 1;
  texture.rgba = {255, 255, 255, 255, 255, 255, 255, 0};
  scene.textures.push_back(texture);
  scene.materials[0].base_color_texture = {.texture = 0, .filter = scene::Filter::nearest};
  scene.materials[0].alpha_mode = scene::AlphaMode::mask;
  add_textured_lamp(scene);
  // Behind the lamp, seen through its holes: another lamp, all of it solid.
  scene::add_material(scene, "behind", {}, gray(3));
  scene::add_rectangle(scene, {2, 4, -0.5f, 0.5f}, 2, false, 1);
  const Points points = floor_points();
  std::vector<double> exact = rectangle_light(points, -0.5, 0, -0.5, 0.5, 1, 2);
  for (size_t i = 0; i < points.size(); ++i) {
    // Seen from x, the solid half [-0.5, 0] hides no more than x + 2 (0 - x) <= 0.9 at height 2.
    const double x = double(points.position[i].x), z = double(points.position[i].z);
    exact[i] += kPiDouble * 3 * rectangle_factor(2 - x, 4 - x, -0.5 - z, 0.5 - z, 2);
  }
  expect_unbiased(solve(scene, points, kDirect), exact);
}

TEST(Lights, ADoubleSidedLampShinesToBothSidesAndAOneSidedToOne) {
  for (const bool two_sided : {false, true}) {
    scene::Scene scene;
    scene::add_material(scene, "lamp", {}, gray(1));
    scene.materials[0].double_sided = two_sided;
    scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, true,
                         0);  // front up: away from the floor
    Points points = floor_points();
    std::vector<double> exact = rectangle_light(points, -0.5, 0.5, -0.5, 0.5, 1, two_sided);
    points.add({0, 2, 0}, {0, -1, 0});
    exact.push_back(kPiDouble * rectangle_factor(-0.5, 0.5, -0.5, 0.5, 1));
    expect_unbiased(solve(scene, points, kDirect), exact);
  }
}

// A mirroring instance keeps its front; a lamp's light must leave from it.
TEST(Lights, AMirroredLampShinesFromItsFront) {
  scene::Scene scene;
  scene::add_material(scene, "lamp", {}, gray(1));
  scene::add_rectangle(scene, {0.1f, 0.5f, -0.5f, 0.5f}, 1, false, 0);
  scene.instances[0].world_from_object = scaling({-1, 1, 1});
  const Points points = floor_points();
  expect_unbiased(solve(scene, points, kDirect),
                  rectangle_light(points, -0.5, -0.1, -0.5, 0.5, 1, 1));
}

// Walls that stand on the floor: seen at all angles, from a distance of nothing to far away.
TEST(Lights, ALampThatTouchesTheReceiverIsSeenExactly) {
  scene::Scene scene;
  scene::add_material(scene, "lamp", {}, gray(1));
  scene::Mesh wall;
  const std::vector<Vec3> corners{{0, 0, -0.5f}, {0, 1, -0.5f}, {0, 1, 0.5f}, {0, 0, 0.5f}};
  scene::add_quad(wall, {corners[0], corners[1], corners[2], corners[3]}, 0);
  ASSERT_GT(scene::geometric_normal_area2({corners[0], corners[1], corners[2]}).x, 0);
  scene::place(scene, std::move(wall));
  Points points;
  std::vector<double> exact;
  for (int k = 0; k < 100; ++k) {
    const Vec3 p{1e-3f * std::pow(1.08f, float(k)), 0, 0.1f};
    points.add(p, {0, 1, 0});
    exact.push_back(kPiDouble * std::abs(polygon_factor(p, {0, 1, 0}, corners)));
  }
  for (int k = 0; k < 10; ++k) {  // in the lamp's own plane, and behind it
    points.add({0, 0, 0.6f + float(k)}, {0, 1, 0}), exact.push_back(0);
    points.add({-0.1f * float(k + 1), 0, 0}, {0, 1, 0}), exact.push_back(0);
  }
  // Rays start 2^-21 m or more above the floor: a thousandth of the nearest distance.
  expect_unbiased(solve(scene, points, kDirect), exact, 2e-3);
}

scene::Scene lamp_scene(const scene::PunctualLight& lamp) {
  scene::Scene scene;
  scene::add_material(scene, "floor", gray(0.5f));
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, 0);
  scene.lights.push_back(lamp);
  return scene;
}

double direct_at(const scene::Scene& scene, Vec3 p, Vec3 n = {0, 1, 0}, int samples = 16) {
  return double(solve(scene, one_point(p, n), {.samples = samples, .bounces = 0}).irradiance[0].x);
}

TEST(Lights, PointLightsFallWithTheSquareAndEndAtTheirRange) {
  scene::PunctualLight lamp;
  lamp.position = {0, 2, 0};
  lamp.intensity = {4, 8, 12};
  EXPECT_NEAR(direct_at(lamp_scene(lamp), {0, 0, 0}), 1.0, 1e-5);
  EXPECT_NEAR(direct_at(lamp_scene(lamp), {2, 0, 0}), 4 / 8.0 * std::sqrt(0.5), 1e-5);
  EXPECT_EQ(direct_at(lamp_scene(lamp), {0, 0, 0}, {0, -1, 0}), 0);
  EXPECT_EQ(direct_at(lamp_scene(lamp), {0, -1, 0}), 0);  // under the floor
  lamp.range_m = 4;
  EXPECT_NEAR(direct_at(lamp_scene(lamp), {0, 0, 0}), 1 - 1.0 / 16, 1e-5);
  lamp.range_m = 2;
  EXPECT_EQ(direct_at(lamp_scene(lamp), {0.01f, 0, 0}), 0);
}

// A ceiling hides nothing that hangs in it, whichever way it faces, and what lies 5 mm above it.
TEST(Lights, ALampInASurfaceLightsWhatLiesBeforeIt) {
  for (const bool up : {false, true})
    for (const float above : {0.0f, -1e-6f, 1e-6f, -1e-5f, 1e-5f, 1e-4f, 5e-3f}) {
      scene::PunctualLight lamp;
      lamp.position = {0, 3 + above, 0}, lamp.intensity = gray(900);
      scene::Scene scene = lamp_scene(lamp);
      scene::add_rectangle(scene, {-5, 5, -5, 5}, 3, up, 0);
      for (const double x : {0.0, 2.0}) {
        const double h = 3 + double(above);
        const double want = above > 1e-3f ? 0 : 900 * h / std::pow(h * h + x * x, 1.5);
        EXPECT_NEAR(direct_at(scene, {float(x), 0, 0}), want, 1e-4 * want) << above << " " << x;
      }
    }
}

TEST(Lights, SpotLightsFadeBetweenTheirCones) {
  scene::PunctualLight lamp;
  lamp.kind = Kind::spot;
  lamp.position = {0, 1, 0};
  lamp.inner_cone_rad = 0.3f, lamp.outer_cone_rad = 0.6f;
  const scene::Scene scene = lamp_scene(lamp);
  for (const double angle : {0.0, 0.25, 0.4, 0.5, 0.59, 0.65}) {
    const double ramp =
        std::clamp((std::cos(angle) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6)), 0.0, 1.0);
    EXPECT_NEAR(direct_at(scene, {float(std::tan(angle)), 0, 0}),
                ramp * ramp * std::pow(std::cos(angle), 3), 1e-4);
  }
}

scene::PunctualLight sun(Vec3 direction, float radius) {
  scene::PunctualLight light;
  light.kind = Kind::directional;
  light.direction = normalize(direction);
  light.angular_radius_rad = radius;
  light.intensity = gray(100);
  return light;
}

TEST(Lights, ASunGivesItsIlluminanceTimesTheCosine) {
  for (const float radius : {0.0f, 0.00465f, 0.3f})
    EXPECT_NEAR(direct_at(lamp_scene(sun({1, -1, 0}, radius)), {0, 0, 0}, {0, 1, 0}, 100000),
                100 * std::sqrt(0.5), radius > 0.1f ? 0.1 : 2e-3);
  EXPECT_EQ(direct_at(lamp_scene(sun({1, 1, 0}, 0.00465f)), {0, 0, 0}), 0);
}

// A disc of angular radius a whose centre stands on the horizon: E = L times the integral of the
// cosine sin(theta) sin(phi) over the upper half, which is 2 L times that of sin^2(theta) to a.
TEST(Lights, ASunOnTheHorizonIsHalved) {
  const float a = 0.1f;
  const double sine = std::sin(0.1), radiance = 100 / (kPiDouble * sine * sine);
  scene::Scene scene;
  scene::add_material(scene, "far", {});
  scene::add_rectangle(scene, {-1, 1, -1, 1}, -9, true, 0);
  scene.lights.push_back(sun({1, 0, 0}, a));
  double integral = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double theta = 0.1 * (i + 0.5) / kSteps;
    integral += 2 * std::sin(theta) * std::sin(theta) * 0.1 / kSteps;
  }
  const TexelPaths e = solve(scene, one_point({0, 0, 0}), {.samples = 200000, .bounces = 0});
  EXPECT_NEAR(double(e.irradiance[0].x), radiance * integral, 3 * double(e.standard_error[0].x));
  EXPECT_LT(e.standard_error[0].x, 0.01f * e.irradiance[0].x);
}

TEST(Lights, AnEdgeThroughTheSunsCentreHidesHalfOfIt) {
  scene::Scene scene = lamp_scene(sun({0, -1, 0}, 0.00465f));
  scene::add_rectangle(scene, {0, 5, -5, 5}, 1, true, 0);
  const TexelPaths e = solve(scene, one_point({0, 0, 0}), {.samples = 40000, .bounces = 0});
  EXPECT_NEAR(e.irradiance[0].x, 50, 3 * e.standard_error[0].x);
  EXPECT_NEAR(e.standard_error[0].x, 50 / std::sqrt(40000.0f), 1e-2f);
}

// Lamps are picked one at a time; their light must add up, whatever is in their way.
TEST(Lights, ManyLampsAddUp) {
  scene::Scene scene = lamp_scene(sun({0.3f, -1, 0.1f}, 0));
  scene::add_rectangle(scene, {1, 2, -2, 2}, 1, true, 0);  // hides some lamps
  const Points points = floor_points();
  std::vector<double> exact(points.size(), 100 / std::sqrt(1 + 0.09 + 0.01));
  for (size_t i = 0; i < points.size(); ++i) {
    const float reach = points.position[i].x - 0.3f;  // where the sun's ray passes height 1
    if (reach > 1 && reach < 2) exact[i] = 0;
  }
  for (int k = 0; k < 100; ++k) {
    scene::PunctualLight lamp;
    lamp.position = {0.07f * float(k) - 3.5f, 2, 0.3f};
    lamp.intensity = gray(1 + float(k % 7));
    scene.lights.push_back(lamp);
    for (size_t i = 0; i < points.size(); ++i) {
      const Vec3 d = lamp.position - points.position[i];
      const float at_one = points.position[i].x + 0.5f * d.x;
      if (at_one < 1 || at_one > 2)
        exact[i] += double(lamp.intensity.x) * 2 / std::pow(double(length(d)), 3);
    }
  }
  expect_unbiased(solve(scene, points, kDirect), exact);
}

// A uniform sky of radiance 2 brings 2 pi, less the light of the part that a rectangle hides.
TEST(Lights, TheBackgroundIsSeenPastSurfaces) {
  scene::Scene scene;
  scene::add_material(scene, "roof", {});
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, false, 0);
  scene.background = gray(2);
  const Points points = floor_points();
  std::vector<double> exact = rectangle_light(points, -0.5, 0.5, -0.5, 0.5, 1, -2);
  for (double& e : exact) e += 2 * kPiDouble;
  expect_unbiased(solve(scene, points, kDirect), exact);
}

/// A sky whose upper half is 1 and lower half 0.3, with a sun of one pixel, of 2 pi / 64 by
/// pi / 32, near the zenith.
scene::Environment half_sky(float sun) {
  scene::Environment map{64, 32, std::vector<Rgb>(64 * 32, gray(0.3f)), 0.5f};
  std::fill(map.radiance.begin(), map.radiance.begin() + 64 * 16, gray(1));
  map.radiance[5 * 64 + 9] = gray(sun);
  return map;
}

// Up: pi + (sun - 1) omega cos(theta). On a wall: the cosine of the azimuth comes in, too.
TEST(Lights, AMapOfTheSky) {
  scene::Scene scene;
  scene::add_material(scene, "far away", gray(0.5f));
  scene::add_rectangle(scene, {900, 901, 900, 901}, -500, false, 0);
  for (const float sun : {1.0f, 40.0f, 80000.0f}) {
    scene.environment = half_sky(sun);
    // The integrals over the pixel's cap: of cos(theta), and of sin(theta) times the azimuth's
    // cosine.
    const double t0 = kPiDouble * 5 / 32, t1 = kPiDouble * 6 / 32, across = 2 * kPiDouble / 64;
    const double up = across * (std::pow(std::sin(t1), 2) - std::pow(std::sin(t0), 2)) / 2;
    const double p0 = across * 9 - kPiDouble + 0.5, p1 = p0 + across;
    const double east =
        (std::sin(p1) - std::sin(p0)) * ((t1 - t0) / 2 - (std::sin(2 * t1) - std::sin(2 * t0)) / 4);
    Points points;
    points.add({0, 0, 0}, {0, 1, 0}), points.add({0, 0, 0}, {-1, 0, 0});
    points.add({0, 0, 0}, {0, -1, 0});
    expect_unbiased(solve(scene, points, kDirect),
                    {kPiDouble + (double(sun) - 1) * up,
                     kPiDouble * 1.3 / 2 - (double(sun) - 1) * east, kPiDouble * 0.3},
                    1e-6);
  }
}

// With its bounce: a white sky over a plane of reflectance rho, seen by a plate that looks down
// from high above, brings the plate rho pi.
TEST(Lights, GroundUnderAMapReflectsIt) {
  scene::Scene scene;
  scene::add_material(scene, "ground", gray(0.5f));
  scene::add_rectangle(scene, {-4000, 4000, -4000, 4000}, 0, true, 0);
  scene.environment = half_sky(1);
  Points points;
  points.add({0, 1, 0}, {0, -1, 0});
  // At most (1 / 4000)^2 of the hemisphere, by the cosine, lies beyond the plane's edge.
  expect_unbiased(solve(scene, points, {.samples = 2000}), {kPiDouble * 0.5}, 1e-4);
}

}  // namespace
}  // namespace luxel::reference
