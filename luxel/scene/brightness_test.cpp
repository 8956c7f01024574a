// The light that may shine in a scene, and the errors that tell of more.
#include "luxel/scene/brightness.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "luxel/scene/procedural.h"

namespace luxel::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string brightness_error(const Scene& scene) {
  const Status status = check_brightness(scene, "f.glb");
  return status ? "none" : status.error().message;
}

/// A box of 1 m around the origin, with a lamp in it.
Scene box_with(PunctualLight::Kind kind, float intensity) {
  Scene box = furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  PunctualLight light;
  light.name = "lamp", light.kind = kind, light.intensity = {0, intensity, 0};
  light.position = world_bounds(box).centre();
  box.lights = {light};
  return box;
}

using Kind = PunctualLight::Kind;

TEST(Brightness, WhatShinesOnEarthIsHeld) {
  EXPECT_EQ(brightness_error(box_with(Kind::directional, 133000)), "none");  // the sun, lux
  EXPECT_EQ(brightness_error(box_with(Kind::spot, 1e9f)), "none");  // a lighthouse, candela
  Scene scene = box_with(Kind::point, 2.6e27f);                     // the sun where it is
  scene.lights[0].position = {0, 1.5e11f, 0};
  EXPECT_EQ(brightness_error(scene), "none");
  scene.background = {1.6e9f, 1.6e9f, 1.6e9f};  // nothing but sun
  EXPECT_EQ(brightness_error(scene), "none");
}

TEST(Brightness, TooBrightLightsAreNamed) {
  for (const float much : {1.1e15f, 1e20f, 1e37f, 3e38f}) {
    const std::string value = fmt::format("{:g}", much);
    EXPECT_THAT(brightness_error(box_with(Kind::directional, much)),
                AllOf(HasSubstr("f.glb: light 0 (lamp): an illuminance of " + value),
                      HasSubstr("1e+15 at most"), HasSubstr("lower its intensity")));
    Scene scene = box_with(Kind::point, 1);
    scene.materials[0].name = "glow", scene.materials[0].emission = {0, 0, much};
    EXPECT_THAT(brightness_error(scene), HasSubstr("material 0 (glow): an emission of " + value));
    scene.materials[0].emission = {}, scene.background = {much, 0, 0};
    EXPECT_THAT(brightness_error(scene), HasSubstr("the background: a radiance of " + value));
    scene.background = {}, scene.environment = {2, 1, {{1, 1, 1}, {1, much, 1}}, 0};
    EXPECT_THAT(brightness_error(scene), HasSubstr("a radiance of " + value + " in pixel (1, 0)"));
  }
}

// The corners of the box are sqrt(3)/2 m away: they get I / 0.75 m^2, and all else gets more.
TEST(Brightness, PointLightsAreJudgedAtTheFarthestPlace) {
  EXPECT_EQ(brightness_error(box_with(Kind::point, 0.74e15f)), "none");
  EXPECT_THAT(brightness_error(box_with(Kind::spot, 0.76e15f)),
              AllOf(HasSubstr("light 0 (lamp): an intensity of 7.6e+14"), HasSubstr("0.866 m")));
  EXPECT_THAT(brightness_error(box_with(Kind::point, 1e32f)),
              HasSubstr("an intensity of 1e+32 is too bright, it may be 1e+30 at most"));
  // Candela of a profile multiply the intensity.
  Scene scene = box_with(Kind::point, 1e10f);
  scene.profiles = {{"lamp.ies", LightProfile::Angles::c, {0, 1}, {0}, {5, 1e9f}}};
  scene.lights[0].profile = 0;
  EXPECT_THAT(brightness_error(scene), HasSubstr("an intensity of 1e+19"));
}

TEST(Brightness, OverflowNamesWhatIsBrightestThere) {
  Scene scene = box_with(Kind::point, 100);
  const Vec3 near = scene.lights[0].position + Vec3{0, 1e-3f, 0};
  EXPECT_THAT(overflow_at(scene, near).message,
              AllOf(HasSubstr("light 0 (lamp), whose intensity of 100 is 0.001 m away")));
  scene.materials[0].name = "glow", scene.materials[0].emission = {1e9f, 0, 0};
  EXPECT_THAT(overflow_at(scene, near).message, HasSubstr("material 0 (glow), whose emission"));
  const std::vector<Rgb> light{{1, 1, 1}, {1e19f, 1, 1}, {NAN, 1, 1}};
  const auto place = [](size_t i) { return Vec3{float(i), 0, 0}; };
  ASSERT_FALSE(check_held(scene, light, place));
  EXPECT_THAT(check_held(scene, light, place).error().message, HasSubstr("the light at (1, 0, 0)"));
  EXPECT_TRUE(check_held(scene, std::span(light).first(1), place));
  EXPECT_FALSE(check_held(scene, std::span(light).last(1), place));
}

}  // namespace
}  // namespace luxel::scene
