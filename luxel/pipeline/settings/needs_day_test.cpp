#include "luxel/pipeline/settings/needs_day.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A block of 0.4 x 1.6 x 0.4 m on a floor, with a badge of 2 x 2 cm on its front that glows as
/// white as a screen.
scene::Scene statue_with_badge(float floor_m = 3) {
  scene::Scene scene;
  const uint32_t stone = scene::add_material(scene, "stone", {0.5f, 0.5f, 0.5f});
  const uint32_t badge = scene::add_material(scene, "badge", {0, 0, 0}, {1, 1, 1});
  const float half = floor_m / 2;
  scene::add_rectangle(scene, {-half, half, -half, half}, 0, true, stone);
  scene::Mesh block;
  scene::add_box(block, {-0.2f, 0, -0.2f}, {0.2f, 1.6f, 0.2f}, stone);
  scene::place(scene, std::move(block));
  scene::Mesh front;
  const float z = 0.201f, b = 0.01f;
  scene::add_quad(front, {Vec3{-b, 1, z}, {b, 1, z}, {b, 1.02f, z}, {-b, 1.02f, z}}, badge);
  scene::place(scene, std::move(front));
  return scene;
}

/// A square that shines down on a floor of 4 x 4 m.
scene::Scene floor_under_lamp(float lamp_m, float height_m, float radiance) {
  scene::Scene scene;
  scene::add_material(scene, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_material(scene, "lamp", {0, 0, 0}, {radiance, radiance, radiance});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, 0);
  const float half = lamp_m / 2;
  scene::add_rectangle(scene, {-half, half, -half, half}, height_m, false, 1);
  return scene;
}

std::string said_of(const scene::Scene& scene) {
  const Result<std::string> said = about_faint_emission(scene);
  EXPECT_TRUE(said);
  return said ? *said : "an error";
}

TEST(NeedsDay, WhereABadgeIsAllThatGlows) {
  EXPECT_THAT(said_of(statue_with_badge()),
              HasSubstr("('badge') leaves 100 % of what can be seen"));
  EXPECT_THAT(said_of(statue_with_badge(100)), HasSubstr("black"));
  const std::string all_threads = said_of(statue_with_badge());
  const ThreadLimit one(1);
  EXPECT_EQ(said_of(statue_with_badge()), all_threads);
}

// E / pi = L A cos^2 / (pi r^2) on the floor is 0.7 below the panel and 0.09 in the corners, below
// the bulb of 5 cm 0.9 and 0.2.
TEST(NeedsDay, NotWhereSomethingLightsTheScene) {
  EXPECT_THAT(said_of(floor_under_lamp(1, 2, 10)), IsEmpty());
  EXPECT_THAT(said_of(floor_under_lamp(0.05f, 3, 1e4f)), IsEmpty());
  EXPECT_THAT(said_of(scene::cornell_box()), IsEmpty());
}

// The day would not get in.
TEST(NeedsDay, NotInAClosedRoom) {
  scene::Scene room = scene::furnace_box({0.5f, 0.5f, 0.5f}, {0, 0, 0});
  const uint32_t badge = scene::add_material(room, "badge", {0, 0, 0}, {1, 1, 1});
  scene::add_rectangle(room, {0.499f, 0.501f, 0.499f, 0.501f}, 0.5f, true, badge);
  EXPECT_THAT(said_of(room), IsEmpty());
}

TEST(NeedsDay, OnlyWhereNobodyChoseLight) {
  const auto added = [](const OutsideLight& outside, scene::Scene scene) {
    const auto warnings = add_outside_light(outside, scene);
    EXPECT_TRUE(warnings);
    const bool is_day = is_lit_by_default_day(outside, scene);
    if (is_day) {
      EXPECT_THAT(warnings->back(),
                  HasSubstr("black, so a clear sky lights it as well, --sky 135,40; --background "
                            "0,0,0 leaves it dark"));
    }
    return is_day;
  };
  EXPECT_TRUE(added({}, statue_with_badge()));
  OutsideLight night;
  night.background = Rgb{};
  EXPECT_FALSE(added(night, statue_with_badge()));
  scene::Scene with_lamp = statue_with_badge();
  with_lamp.lights.emplace_back();
  EXPECT_FALSE(added({}, with_lamp));
}

}  // namespace
}  // namespace luxel::pipeline
