// Covered places: form factors of strips in closed form, and what is no cover.
#include "luxel/transport/covers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"

namespace luxel::transport {
namespace {

constexpr float kHeight_m = 0.01f, kSize_m = 0.2f;
const Vec3 kUp{0, 1, 0};

/// A floor, and over its half x > 0 a plate without visible end.
scene::Scene floor_under_plate(bool up) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, gray);
  scene::add_rectangle(scene, {0, 5, -5, 5}, kHeight_m, up, gray);
  return scene;
}

float share_at(const scene::Scene& scene, Vec3 position, Vec3 normal, float size_m) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  return open_share(*tracer, scene::off_surface(position, normal, 1), normal, size_m);
}

TEST(Covers, TheOpenShareIsTheFormFactorOfTheGap) {
  for (const bool up : {false, true}) {  // whether the plate shows its front or its back below
    const scene::Scene scene = floor_under_plate(up);
    for (const float x : {0.014f, 0.02f, 0.03f, 0.05f}) {
      const double gap = (1 - double(x) / std::hypot(double(x), double(kHeight_m))) / 2;
      // 64 stratified rays know a share to about one of them; 0.004 of the rays are too flat.
      EXPECT_NEAR(share_at(scene, {x, 0, 0}, kUp, kSize_m), gap, 0.02) << x;
    }
    EXPECT_EQ(share_at(scene, {1, 0, 0}, kUp, kSize_m), 0);
  }
}

TEST(Covers, PlacesBesideTheCoverAndAtItsBorderAreNotCovered) {
  const scene::Scene scene = floor_under_plate(true);
  EXPECT_EQ(share_at(scene, {-0.001f, 0, 0}, kUp, kSize_m), 1);
  EXPECT_EQ(share_at(scene, {0.005f, 0, 0}, kUp, kSize_m), 1);  // a quarter is open
  EXPECT_EQ(share_at(scene, {1, kHeight_m, 0}, kUp, kSize_m), 1);
  EXPECT_EQ(share_at(scene, {1, kHeight_m, 0}, -kUp, kSize_m), 0);
}

// From a strip of half the width w, h above an endless floor, the part of the floor that does not
// lie below the strip is 1 - w / sqrt(w^2 + h^2) of the hemisphere, seen from the strip's middle.
TEST(Covers, AStripSeesTheFloorBesideIt) {
  const auto middle_of_strip = [](float half_m) {
    scene::Scene scene;
    const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
    scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, gray);
    scene::add_rectangle(scene, {-half_m, half_m, -5, 5}, kHeight_m, false, gray);
    return share_at(scene, {0, kHeight_m, 0}, -kUp, kSize_m);
  };
  EXPECT_EQ(middle_of_strip(0.2f * kHeight_m), 1);
  EXPECT_EQ(middle_of_strip(kHeight_m), 1);  // 0.29 is open
  // 0.030 is open; 64 stratified rays know that to about one of them.
  EXPECT_NEAR(middle_of_strip(4 * kHeight_m), 0.030, 0.02);
}

TEST(Covers, AreLowerThanAQuarterOfTheSize) {
  const scene::Scene scene = floor_under_plate(true);
  EXPECT_EQ(share_at(scene, {1, 0, 0}, kUp, 3.8f * kHeight_m), 1);
  EXPECT_EQ(share_at(scene, {1, 0, 0}, kUp, 4.2f * kHeight_m), 0);
}

// A room of 4 m whose elements are as large as itself: a table is no cover, nor are walls.
TEST(Covers, ATableInASmallRoomIsNone) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh room, top;
  scene::add_box(room, {-2, 0, -2}, {2, 2.8f, 2}, gray);
  scene::add_box(top, {-0.6f, 0.7f, -0.4f}, {0.6f, 0.74f, 0.4f}, gray);
  scene::place(scene, std::move(room)), scene::place(scene, std::move(top));
  EXPECT_EQ(share_at(scene, {0, 0, 0}, kUp, 4), 1);
  EXPECT_EQ(share_at(scene, {-1.999f, 0, -1.999f}, kUp, 4), 1);
  EXPECT_EQ(share_at(scene, {0, 0.74f, 0}, kUp, 4), 1);
}

// Wide plates of which one shines have all of their light between them: nothing is covered. The
// same plate that does not shine, under a lamp, covers the floor.
TEST(Covers, AreNoneWhereTheLightIsMadeInTheGap) {
  for (const bool plate_shines : {true, false}) {
    scene::Scene scene = floor_under_plate(false);
    const uint32_t lamp = scene::add_material(scene, "lamp", {0, 0, 0}, {1, 1, 1});
    scene::add_rectangle(scene, {0, 5, -5, 5}, plate_shines ? 0.9f * kHeight_m : 3, false, lamp);
    const auto tracer = trace::RayTracer::build(scene);
    ASSERT_TRUE(tracer);
    EXPECT_EQ(size_for_covers(scene, *tracer, kSize_m), plate_shines ? 0 : kSize_m);
  }
}

}  // namespace
}  // namespace luxel::transport
