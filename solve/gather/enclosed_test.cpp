// Which texels lie inside of solids.
#include <gtest/gtest.h>

#include <array>

#include "scene/shapes.h"
#include "solve/gather/gather_test_support.h"
#include "transport/point_form_factor.h"

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
        std::abs(transport::point_to_polygon(elements.position[i], elements.normal[i], plate));
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

}  // namespace
}  // namespace luxel::gather
