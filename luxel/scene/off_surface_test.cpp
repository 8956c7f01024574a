#include "luxel/scene/off_surface.h"

#include <gtest/gtest.h>

#include "luxel/scene/facet.h"

namespace luxel::scene {
namespace {

// A floor of 4 km along the axes: an eighth of its side. Its corners are float's, so its plane is
// exact.
TEST(OffSurface, SizeOfALongFloorIsAnEighth) {
  EXPECT_EQ(size_for_rounding({}, {4000, 0, 8}, {0, 1, 0}), 500);
}

// Turned by arctan(3 / 4) its box is 800 by 600, and 4 (0.6 * 800 + 0.8 * 600) is 3840.
TEST(OffSurface, SizeOfATurnedWallIsFourTimesWhatItsNormalSees) {
  const Vec3 extent{800, 10, 600};
  EXPECT_FLOAT_EQ(size_for_rounding({}, extent, {0.6f, 0, 0.8f}), 3840);
  EXPECT_FLOAT_EQ(size_for_rounding({}, extent, {-0.6f, 0, -0.8f}), 3840);
}

TEST(OffSurface, SizeIsNoLessThanTheInstancesTranslation) {
  EXPECT_EQ(size_for_rounding({}, {1, 1, 0}, {0, 0, 1}), 0.125f);
  EXPECT_EQ(size_for_rounding(translation({3, -7000, 2}), {1, 1, 0}, {0, 0, 1}), 7000);
}

// 2^-21 of the larger of coordinate and size, along the normal.
TEST(OffSurface, MovesAlongTheNormal) {
  EXPECT_EQ(rounding_m({1, -1024, 2}, 3), 0x1p-11f);
  EXPECT_EQ(rounding_m({1, -2, 2}, 2048), 0x1p-10f);
  EXPECT_EQ(off_surface({1, 0, 2}, {0, -1, 0}, 1024), (Vec3{1, -0x1p-11f, 2}));
}

TEST(OffSurface, LeavesAPointOfASceneToTheSideAskedFor) {
  Scene scene;
  scene.meshes.push_back({});
  scene.meshes[0].positions = {{0, 0, 0}, {4, 0, 0}, {0, 0, -4}};
  scene.meshes[0].triangles = {{0, 1, 2}};
  scene.instances.push_back({"", 0, translation({0, 1024, 0})});
  const SurfacePoint p{0, 0, {0.5f, 0.25f}};
  EXPECT_EQ(facet_of(scene, 0, 0).size_m, 1024);
  EXPECT_EQ(off_surface(scene, p, {0, 1, 0}), (Vec3{2, 1024 + 0x1p-11f, -1}));
  EXPECT_EQ(off_surface(scene, p, {0, -1, 0}), (Vec3{2, 1024 - 0x1p-11f, -1}));
}

}  // namespace
}  // namespace luxel::scene
