#include "luxel/scene/surface_points.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

// Floor of 3 x 2 m and lid of 1 x 1 m: 6 of 7 points lie on the floor, their mean in its middle. An
// even spread of 7000 knows a mean far better than the 1 / sqrt(7000) = 0.012 of independent ones.
TEST(SurfacePoints, AreSpreadEvenlyByArea) {
  Scene scene;
  add_material(scene, "floor", {}), add_material(scene, "lid", {});
  add_rectangle(scene, {0, 3, 0, 2}, 0, true, 0);
  add_rectangle(scene, {0, 1, 0, 1}, 1, false, 1);
  double on_floor = 0;
  Vec3 sum{};
  for (const SurfacePoint& p : points_uniform_in_area(scene, 7000, 1)) {
    if (p.instance != 0) continue;
    ++on_floor, sum += world_position(scene, p);
  }
  EXPECT_NEAR(on_floor, 6000, 1);
  EXPECT_NEAR(double(sum.x) / on_floor, 1.5, 0.002);
  EXPECT_NEAR(double(sum.z) / on_floor, 1, 0.002);
  for (const SurfacePoint& p : points_uniform_in_area(scene, 100, 2, of_material(1)))
    EXPECT_EQ(p.instance, 1u);
}

}  // namespace
}  // namespace luxel::scene
