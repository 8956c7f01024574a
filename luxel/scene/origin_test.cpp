#include "luxel/scene/origin.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"

namespace luxel::scene {
namespace {

TEST(Origin, IsAddedAndTakenOffInDoublePrecision) {
  Scene scene;
  scene.origin = {512344, 88, -5403216};
  const DVec3 at{512345.678, 87.5, -5403210.123};
  EXPECT_EQ(in_scene(scene, at), (Vec3{1.678f, -0.5f, 5.877f}));
  const DVec3 back = in_world(scene, {1.678f, -0.5f, 5.877f});
  EXPECT_NEAR(back.x, at.x, 1e-6);
  EXPECT_EQ(back.y, at.y);
  EXPECT_NEAR(back.z, at.z, 1e-6);
  EXPECT_TRUE(std::signbit(in_world(Scene{}, {-0.0f, 0, 0}).x)) << "where there is none";
}

TEST(ShortNumber, IsWhatAPersonWouldWrite) {
  EXPECT_EQ(short_number(0.1f), 0.1);
  EXPECT_EQ(short_number(2e5f), 2e5);
  EXPECT_EQ(short_number(1.678f, 512344), 512345.678);
  EXPECT_EQ(short_number(5.877f, -5403216), -5403210.123);
  EXPECT_EQ(short_number(-0.5f, 88), 87.5);
  EXPECT_EQ(short_number(0, 65536), 65536);
}

TEST(ShortNumber, IsReadAsTheSameFloat) {
  RandomStream random{7, 0};
  for (const double origin : {0.0, 65536.0, -5403216.0, 0.25})
    for (int k = 0; k < 1000; ++k) {
      const float value = 40 * random.next() - 20;
      EXPECT_EQ(float(short_number(value, origin) - origin), value) << origin;
    }
}

}  // namespace
}  // namespace luxel::scene
