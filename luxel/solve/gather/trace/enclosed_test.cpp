// Texels inside of solids.
#include <gtest/gtest.h>

#include <array>

#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::gather {
namespace {

// A plate above a floor shows its back to it. A floor's point lies inside of a solid, by the rule,
// where the plate's form factor is more than 1/2. The 64 rays of the set that decides are as exact
// as 0.1: strata of 1/8 by 1/8, of which at most 2 x 8 are cut by the plate's edges there. Nearer
// to 1/2 nobody knows; but every seed and number of samples says the same.
TEST(Enclosed, IsTheSameForAllSeeds) {
  constexpr float kHeight = 0.2f;
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t white = scene::add_material(scene, "white", {0.5f, 0.5f, 0.5f}, {});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, white);
  scene::add_rectangle(scene, {-1, 1, -1, 1}, kHeight, true, white);
  const std::array<Vec3, 4> plate{Vec3{-1, kHeight, -1}, Vec3{1, kHeight, -1}, Vec3{1, kHeight, 1},
                                  Vec3{-1, kHeight, 1}};
  const auto room = lay_out(std::move(scene), 96);
  const transport::Elements& elements = room->elements;
  const auto enclosed = [&](int samples, uint64_t seed) {
    return solve(*room, {.samples = samples, .seed = seed}).enclosed;
  };
  const std::vector<uint8_t> first = enclosed(64, 1);
  size_t inside = 0, outside = 0, unsure = 0;
  for (size_t i = 0; i < elements.size(); ++i) {
    if (elements.position[i].y > 0.1f) continue;
    const double f =
        std::abs(viewfactor::point_to_polygon(elements.position[i], elements.normal[i], plate));
    const bool sure = std::abs(f - 0.5) > 0.1;
    if (sure) {
      EXPECT_EQ(first[i], f > 0.5) << f;
    }
    ++(!sure ? unsure : f > 0.5 ? inside : outside);
  }
  EXPECT_GT(inside, 100u);
  EXPECT_GT(outside, 100u);
  EXPECT_GT(unsure, 20u);
  EXPECT_EQ(enclosed(64, 2), first);
  EXPECT_EQ(enclosed(96, 3), first);
  EXPECT_EQ(enclosed(256, 4), first);
}

/// A closed box on a floor, with a plate in it, under an even sky and a lamp. The floor ends at the
/// box: no texel lies on both sides of its walls.
std::unique_ptr<Room> box_with_plate(bool double_sided) {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  const uint32_t wall = scene::add_material(scene, "wall", {0.8f, 0.7f, 0.6f}, {});
  scene.materials[wall].double_sided = double_sided;
  scene::Mesh floor, box;
  const auto square = [](float half) {
    return scene::Quad{Vec3{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}};
  };
  scene::add_quad_with_hole(floor, square(3), square(0.5f), gray);
  scene::place(scene, std::move(floor));
  scene::add_box(box, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, wall);
  scene::place(scene, std::move(box));
  scene::add_rectangle(scene, {-0.45f, 0.45f, -0.45f, 0.45f}, 0.05f, true, gray);
  scene.lights.resize(1);
  scene.lights[0].position = {1, 3, 0.5f}, scene.lights[0].intensity = {4, 4, 4};
  return lay_out(std::move(scene), 64);
}

// From outside nobody sees whether a solid's walls have a back. Inside it is dark, and finding that
// out takes no more rays than it does where backs bring nothing.
TEST(Enclosed, SolidsLookTheSameFromOutsideWithTwoSidesAndWithOne) {
  const auto one = box_with_plate(false), two = box_with_plate(true);
  ASSERT_EQ(one->elements.position, two->elements.position);
  const Gather expected = solve(*one, with_samples(64)), found = solve(*two, with_samples(64));
  EXPECT_EQ(found.enclosed, expected.enclosed);
  size_t inside = 0, outside = 0;
  for (size_t i = 0; i < found.irradiance.size(); ++i) {
    EXPECT_EQ(found.irradiance[i], expected.irradiance[i]) << "the same rays, in the same order";
    ++(expected.enclosed[i] ? inside : outside);
    if (expected.enclosed[i]) {
      EXPECT_EQ(found.irradiance[i], Rgb{});
    }
  }
  EXPECT_GT(inside, 10u);
  EXPECT_GT(outside, 500u);
  EXPECT_EQ(found.rays, expected.rays);
}

}  // namespace
}  // namespace luxel::gather
