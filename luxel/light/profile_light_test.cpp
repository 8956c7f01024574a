// Lamps with a measured distribution, in closed form.
#include <gtest/gtest.h>

#include "luxel/light/direct_light.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"

namespace luxel::light {
namespace {

constexpr float kDegree = kPi / 180;

/// 100 cos(v) cd, every half degree to 90.
scene::LightProfile plate_profile() {
  scene::LightProfile p;
  p.horizontal_rad = {0};
  for (int i = 0; i <= 180; ++i) {
    p.vertical_rad.push_back(0.5f * float(i) * kDegree);
    p.candela.push_back(100 * std::max(0.0f, std::cos(p.vertical_rad.back())));
  }
  return p;
}

/// A large floor under a lamp 2 m above it.
scene::Scene lamp_scene(scene::PunctualLight lamp, float scale) {
  scene::Scene scene;
  scene::add_material(scene, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-20, 20, -20, 20}, 0, true, 0);
  lamp.position = {0, 2, 0};
  scene.lights.push_back(lamp);
  scene::attach_profile(scene, 0, plate_profile(), scale);
  return scene;
}

Rgb floor_light(const scene::Scene& scene, float x, float z) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  transport::Elements at;
  at.position = {scene::off_surface({x, 0, z}, {0, 1, 0}, 1)},
  at.normal = at.geometric_normal = {{0, 1, 0}}, at.reflectance = {{}};
  Progress progress;
  const auto light = direct_light(scene, at, collect_lights(scene), *tracer, {1, 1}, progress);
  EXPECT_TRUE(light);
  return light->irradiance[0];
}

// I = 100 cos v above a floor h = 2 below: E = 100 cos^2 v / d^2 = 100 h^2 / d^4. Interpolation
// between half degrees is off by 1e-5 of 100 cd: 1e-5 / cos v of E.
TEST(ProfileLight, ACosineOverAFloor) {
  scene::PunctualLight lamp;
  lamp.intensity = {30, 15, 0};  // its colour counts, its brightness does not
  const scene::Scene scene = lamp_scene(lamp, 1);
  for (const float r : {0.0f, 0.7f, 2.0f, 5.0f}) {
    const float d2 = 4 + r * r, e = 400 / (d2 * d2);
    EXPECT_NEAR(floor_light(scene, r * 0.6f, r * 0.8f).x, e, 1e-4f * e) << r;
    EXPECT_NEAR(floor_light(scene, r, 0).y, 0.5f * e, 1e-4f * e) << r;
    EXPECT_EQ(floor_light(scene, r, 0).z, 0) << r;
  }
}

// The lamp leans by 30 degrees to +x: at x = 2 tan 30 it shines straight.
TEST(ProfileLight, TurnsWithItsLamp) {
  scene::PunctualLight lamp;
  lamp.direction = {0.5f, -std::sqrt(0.75f), 0};
  const scene::Scene scene = lamp_scene(lamp, 1);
  const float x = 2 * std::tan(30 * kDegree), d2 = 4 + x * x;
  EXPECT_NEAR(floor_light(scene, x, 0).x, 100 / d2 * std::cos(30 * kDegree), 1e-3f);
  // Straight below it is 30 degrees off its aim.
  EXPECT_NEAR(floor_light(scene, 0, 0).x, 100 / 4.0f * std::cos(30 * kDegree), 1e-3f);
}

// glTF's window and cone are factors on what the profile sends, and so is the scale.
TEST(ProfileLight, RangeAndConeStillApply) {
  scene::PunctualLight lamp;
  lamp.range_m = 4;
  const float d2 = 4 + 1.0f, e = 400 / (d2 * d2), q2 = d2 / 16;
  EXPECT_NEAR(floor_light(lamp_scene(lamp, 3), 1, 0).x, 3 * e * (1 - q2 * q2), 1e-3f);
  lamp.range_m = 0;
  lamp.kind = scene::PunctualLight::Kind::spot;
  lamp.inner_cone_rad = 0.2f, lamp.outer_cone_rad = 0.8f;
  const float cosine = 2 / std::sqrt(d2);
  const float ramp = (cosine - std::cos(0.8f)) / (std::cos(0.2f) - std::cos(0.8f));
  EXPECT_NEAR(floor_light(lamp_scene(lamp, 1), 1, 0).x, e * ramp * ramp, 1e-3f);
  EXPECT_EQ(floor_light(lamp_scene(lamp, 1), 3, 0).x, 0);
}

}  // namespace
}  // namespace luxel::light
