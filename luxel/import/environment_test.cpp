#include "luxel/import/environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

image::Image picture_of(int width, int height) {
  image::Image picture(width, height, 3);
  for (float& v : picture.data) v = 1;
  return picture;
}

TEST(ReadEnvironment, ScalesAndKeepsTheRows) {
  image::Image picture = picture_of(8, 4);
  picture.set_rgb(3, 1, {2, 4, 8});
  const auto e = environment_from(picture, "sky", 0.5f, 0.25f);
  ASSERT_TRUE(e);
  EXPECT_EQ(e->map.radiance[8 + 3], (Rgb{0.5f, 1, 2}));
  EXPECT_EQ(e->map.radiance[0], (Rgb{0.25f, 0.25f, 0.25f}));
  EXPECT_EQ(e->map.rotation_rad, 0.5f);
  EXPECT_TRUE(e->warnings.empty());
}

TEST(ReadEnvironment, RefusesWhatIsNoLight) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    image::Image picture = picture_of(8, 4);
    picture.at(5, 2)[1] = bad;
    const auto e = environment_from(picture, "sky", 0, 1);
    ASSERT_FALSE(e);
    EXPECT_THAT(e.error().message, HasSubstr("pixel (5, 2)"));
  }
  // Finite in the file, not any more after scaling.
  image::Image picture = picture_of(8, 4);
  picture.at(0, 0)[0] = 3e38f;
  EXPECT_FALSE(environment_from(picture, "sky", 0, 10));
}

TEST(ReadEnvironment, RefusesOtherShapes) {
  for (const auto& [width, height] : {std::pair{8, 8}, {9, 4}, {6, 4}, {4, 8}}) {
    const auto e = environment_from(picture_of(width, height), "sky", 0, 1);
    ASSERT_FALSE(e);
    EXPECT_THAT(e.error().message, HasSubstr("twice as wide as high"));
  }
}

TEST(ReadEnvironment, TakesNegativeLightForNone) {
  image::Image picture = picture_of(8, 4);
  picture.set_rgb(1, 1, {-1, 2, 3});
  const auto e = environment_from(picture, "sky", 0, 1);
  ASSERT_TRUE(e);
  EXPECT_EQ(e->map.radiance[9], (Rgb{0, 2, 3}));
  ASSERT_EQ(e->warnings.size(), 1u);
  EXPECT_THAT(e->warnings[0], HasSubstr("1 pixels"));
}

}  // namespace
}  // namespace luxel::import
