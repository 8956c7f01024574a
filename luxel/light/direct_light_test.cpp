#include "luxel/light/direct_light.h"

#include <gtest/gtest.h>

#include "luxel/scene/light_kinds.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "tests/reference_data.h"

namespace luxel::light {
namespace {

namespace shared = luxel::testing_support;

transport::Elements element_at(Vec3 position, Vec3 normal) {
  transport::Elements e;
  e.position = {scene::off_surface(position, normal, 1)}, e.normal = e.geometric_normal = {normal},
  e.reflectance = {{0.5f, 0.5f, 0.5f}};
  return e;
}

Rgb direct_at(const scene::Scene& scene, Vec3 position, Vec3 normal, int samples) {
  auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  Progress progress;
  const auto light = direct_light(scene, element_at(position, normal), light::collect_lights(scene),
                                  *tracer, {samples, 1}, progress);
  EXPECT_TRUE(light);
  return light->irradiance[0];
}

// The exact factors at nine points of the Cornell box, past both blocks and in the empty box.
TEST(DirectLight, MatchesTheExactCornellProbes) {
  const auto rows =
      shared::markdown_rows("reference/cornell-box.md", "Exact direct light", "surface");
  ASSERT_EQ(rows.size(), 9u);
  for (const bool with_blocks : {false, true}) {
    const scene::Scene scene = scene::cornell_box(scene::CornellColors::pbrt, with_blocks);
    const light::Lights lights = light::collect_lights(scene);
    ASSERT_FALSE(lights.triangles.empty());
    const Rgb radiance = lights.triangles[0].mean_radiance;
    for (const auto& row : rows) {
      const std::string& cell = row[with_blocks ? 4 : 3];
      if (cell == "-") continue;
      const double exact = std::stod(cell);
      // The table is in millimetres, the scene in metres.
      const Rgb e =
          direct_at(scene, shared::parse_vec3(row[1]) * 1e-3f, shared::parse_vec3(row[2]), 4096);
      for (const auto& [value, l] :
           {std::pair{e.x, radiance.x}, {e.y, radiance.y}, {e.z, radiance.z}})
        EXPECT_NEAR(value / (kPi * l), exact, 0.005 * exact)
            << row[0] << " " << row[1] << (with_blocks ? " with" : " without") << " blocks";
    }
  }
}

scene::Scene one_quad_scene(scene::PunctualLight light) {
  scene::Scene scene;
  scene.materials.push_back({});
  scene::Mesh floor;
  floor.positions = {{-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.triangle_material = {0, 0};
  scene.meshes.push_back(floor);
  scene.instances.push_back({});
  scene.lights.push_back(light);
  return scene;
}

TEST(DirectLight, APointLightFallsWithTheSquareOfTheDistance) {
  scene::PunctualLight lamp;
  lamp.position = {0, 2, 0};
  lamp.intensity = {4, 8, 12};
  const scene::Scene scene = one_quad_scene(lamp);
  // I cos / d^2 = I / 4 below it; at (2, 0, 0): d^2 = 8, cos = 1 / sqrt 2.
  EXPECT_NEAR(direct_at(scene, {0, 0, 0}, {0, 1, 0}, 1).y, 2.0f, 1e-5f);
  EXPECT_NEAR(direct_at(scene, {2, 0, 0}, {0, 1, 0}, 1).x, 4 / 8.0f * std::sqrt(0.5f), 1e-6f);
  EXPECT_EQ(direct_at(scene, {0, 0, 0}, {0, -1, 0}, 1), (Rgb{0, 0, 0}));
}

/// A floor under a lamp of 900 in or beside a ceiling at 3 m.
enum class Ceiling { faces_down, faces_up, slab };
scene::Scene under_a_ceiling(Ceiling kind, float height_m, bool is_spot) {
  scene::PunctualLight lamp;
  lamp.position = {0, height_m, 0}, lamp.intensity = {900, 900, 900};
  if (is_spot) lamp.kind = scene::LightKind::spot;
  lamp.inner_cone_rad = 0.7f, lamp.outer_cone_rad = 0.8f;
  scene::Scene scene = one_quad_scene(lamp);
  if (kind != Ceiling::slab) {
    scene::add_rectangle(scene, {-5, 5, -5, 5}, 3, kind == Ceiling::faces_up, 0);
    return scene;
  }
  scene::Mesh slab;
  scene::add_box(slab, {-5, 3, -5}, {5, 3.02f, 5}, 0);
  scene::place(scene, std::move(slab));
  return scene;
}

// E = I h / (h^2 + x^2)^(3/2), as if there were no ceiling.
TEST(DirectLight, ALampInASurfaceLightsWhatLiesBeforeIt) {
  for (const Ceiling kind : {Ceiling::faces_down, Ceiling::faces_up, Ceiling::slab})
    for (const float above : {0.0f, -1e-6f, 1e-6f, -1e-5f, 1e-5f, 1e-4f})
      for (const bool is_spot : {false, true})
        for (const double x : {0.0, 2.0}) {
          const double h = 3 + double(above), want = 900 * h / std::pow(h * h + x * x, 1.5);
          const scene::Scene scene = under_a_ceiling(kind, 3 + above, is_spot);
          EXPECT_NEAR(double(direct_at(scene, {float(x), 0, 0}, {0, 1, 0}, 1).x), want, 1e-4 * want)
              << int(kind) << " " << above << " " << is_spot << " " << x;
        }
}

TEST(DirectLight, ALampBehindASurfaceIsHidden) {
  for (const Ceiling kind : {Ceiling::faces_down, Ceiling::faces_up, Ceiling::slab})
    EXPECT_EQ(direct_at(under_a_ceiling(kind, 3.005f, false), {0, 0, 0}, {0, 1, 0}, 1), Rgb{});
  // A shade of 2 cm, 1 cm below a lamp at 10 m.
  scene::Scene scene = under_a_ceiling(Ceiling::faces_down, 10, false);
  scene.instances.pop_back();
  EXPECT_NEAR(direct_at(scene, {0, 0, 0}, {0, 1, 0}, 1).x, 9, 1e-3f);
  scene::add_rectangle(scene, {-0.01f, 0.01f, -0.01f, 0.01f}, 9.99f, true, 0);
  EXPECT_EQ(direct_at(scene, {0, 0, 0}, {0, 1, 0}, 1), Rgb{});
}

TEST(DirectLight, ASunGivesItsIlluminanceTimesTheCosine) {
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{1, -1, 0});
  sun.intensity = {100, 100, 100};
  sun.angular_radius_rad = 0.00465f;
  EXPECT_NEAR(direct_at(one_quad_scene(sun), {0, 0, 0}, {0, 1, 0}, 16).x, 100 * std::sqrt(0.5f),
              1e-3f);
}

// A half plane's edge halves the sun's disc: the point whose direction to the edge is the disc's
// centre sees half of it.
TEST(DirectLight, AnEdgeThroughTheSunsCentreHidesHalfOfIt) {
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = {0, -1, 0};
  sun.angular_radius_rad = 0.00465f;
  sun.intensity = {1, 1, 1};
  scene::Scene scene = one_quad_scene(sun);
  scene::Mesh shade;
  shade.positions = {{0, 1, -5}, {0, 1, 5}, {5, 1, 5}, {5, 1, -5}};
  shade.triangles = {{0, 1, 2}, {0, 2, 3}};
  shade.triangle_material = {0, 0};
  scene.meshes.push_back(shade);
  scene.instances.push_back({"shade", 1, {}});
  // 1024 stratified samples of an edge: about n^-3/4 = 0.6 %.
  EXPECT_NEAR(direct_at(scene, {0, 0, 0}, {0, 1, 0}, 1024).x, 0.5f, 0.01f);
}

// 2000 small lights on a hemisphere of radius 1 with total area A: E = sum L A_i cos_i, computed
// here one by one. More lights than a cut holds, so groups are sampled.
TEST(DirectLight, ManyLightsAreSampledWithoutBias) {
  scene::Scene scene = one_quad_scene({});
  scene.lights.clear();
  scene.materials.push_back({});
  scene.materials[1].emission = {1, 2, 3};
  scene::Mesh lamps;
  double expected = 0;
  for (int i = 0; i < 2000; ++i) {
    const float z = (float(i) + 0.5f) / 2000, phi = 2.39996f * float(i);
    const float r = std::sqrt(1 - z * z);
    const Vec3 d{r * std::cos(phi), z, r * std::sin(phi)};
    const Frame f = frame_around(-d);
    const float h = 0.01f;
    const uint32_t first = uint32_t(lamps.positions.size());
    lamps.positions.insert(lamps.positions.end(), {d, d + f.tangent * h, d + f.bitangent * h});
    lamps.triangles.push_back({first, first + 1, first + 2});
    lamps.triangle_material.push_back(1);
    expected += 0.5 * double(h) * double(h) * double(z);
  }
  scene.meshes.push_back(lamps);
  scene.instances.push_back({"lamps", 1, {}});
  // A group's importance takes no account of the emitters' own cosines, so single samples scatter
  // by about half the mean: 16,384 of them err by 0.4 %, four of those errors are 1.6 %.
  const Rgb e = direct_at(scene, {0, 0, 0}, {0, 1, 0}, 16384);
  EXPECT_NEAR(e.x / expected, 1.0, 0.016);
  EXPECT_NEAR(e.z / expected, 3.0, 0.048);
}

/// L = 1 + cos(theta) over both hemispheres, and a sun of one pixel at 30 degrees from the zenith
/// over +X, of 2 pi / 128 by pi / 64.
scene::Environment gradient_with_sun(float sun) {
  scene::Environment map{128, 64, {}, 0};
  for (int y = 0; y < map.height; ++y) {
    const float theta = kPi * (float(y) + 0.5f) / 64;
    map.radiance.insert(map.radiance.end(), 128, Rgb{1, 1, 1} * (1 + std::cos(theta)));
  }
  map.radiance[10 * 128 + 64] += Rgb{sun, sun, sun};
  return map;
}

Rgb under_sky(const scene::Scene& scene, Vec3 position, Vec3 normal, DirectParams params) {
  auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  const auto light = direct_light(scene, element_at(position, normal), light::collect_lights(scene),
                                  *tracer, params, progress);
  EXPECT_TRUE(light);
  return light->irradiance[0];
}

// E = integral of (1 + c) c 2 pi dc = pi + 2 pi / 3; looking down pi - 2 pi / 3.
TEST(DirectLight, ASkyOfKnownGradient) {
  scene::Scene scene = one_quad_scene({});
  scene.lights.clear();
  scene.environment = gradient_with_sun(0);
  const DirectParams params{16, 1, false, 1 << 14};
  // Pixels are 2.8 degrees high: constant over each, the gradient's integral is off by
  // (pi / 64)^2 / 24 of it.
  EXPECT_NEAR(under_sky(scene, {0, 1, 0}, {0, 1, 0}, params).x, kPi * 5 / 3, 2e-3f);
  scene.instances[0].world_from_object.row[1][3] = 50;  // out of sight of what looks down
  EXPECT_NEAR(under_sky(scene, {0, 1, 0}, {0, -1, 0}, params).x, kPi / 3, 2e-3f);
}

// The sun's pixel alone: L times its solid angle times the cosine, and nothing behind a plate.
TEST(DirectLight, ABrightTexelOfTheSkyIsAimedAt) {
  scene::Scene scene = one_quad_scene({});
  scene.lights.clear();
  scene.environment = gradient_with_sun(1e5f);
  const Surroundings around = surroundings_of(scene);
  const double theta = kPiDouble * 10.5 / 64, half = kPiDouble / 128;
  const double omega = 2 * kPiDouble / 128 * 2 * std::sin(theta) * std::sin(half);
  const double radiance = 1e5 + 1 + std::cos(theta) - double(around.limit);
  // The cosine averages to its middle over the pixel to half^2 / 6.
  const double expected = radiance * omega * std::cos(theta);
  EXPECT_NEAR(under_sky(scene, {0, 1, 0}, {0, 1, 0}, {64, 1}).x, expected, 5e-4 * expected);
  scene.instances[0].world_from_object.row[1][3] = 2;
  EXPECT_EQ(under_sky(scene, {0, 1, 0}, {0, 1, 0}, {64, 1}), (Rgb{}));
}

}  // namespace
}  // namespace luxel::light
