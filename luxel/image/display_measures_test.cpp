#include "luxel/image/display_measures.h"

#include <gmock/gmock.h>

namespace luxel::image {
namespace {

using ::testing::ElementsAre;

TEST(DisplayMeasures, BrightnessOfKnownColours) {
  const Image8 image{
      6, 1, 3, {0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 77, 77, 77}};
  // 0.2126, 0.7152 and 0.0722 of 255
  EXPECT_THAT(brightness(image), ElementsAre(0, 255, 54, 182, 18, 77));
}

TEST(DisplayMeasures, TheLargestChannelDiffersAndAlphaDoesNot) {
  const Image8 a{3, 1, 3, {0, 0, 0, 10, 200, 30, 5, 5, 5}};
  const Image8 b{3, 1, 4, {255, 255, 255, 0, 15, 190, 60, 9, 5, 5, 5, 255}};
  EXPECT_THAT(pixel_differences(a, b), ElementsAre(255, 30, 0));
  EXPECT_THAT(pixel_differences(b, a), ElementsAre(255, 30, 0));
}

TEST(DisplayMeasures, SharesCountCoveredPixelsStrictlyAbove) {
  const std::vector<uint8_t> values{0, 10, 11, 40, 41, 255, 255};
  const Histogram counts = histogram(values, {1, 1, 1, 1, 1, 0, 0});
  EXPECT_EQ(counts[255], 0u);
  EXPECT_EQ(counts[11], 1u);
  EXPECT_DOUBLE_EQ(share_above(counts, 10), 0.6);
  EXPECT_DOUBLE_EQ(share_above(counts, 25), 0.4);
  EXPECT_DOUBLE_EQ(share_above(counts, 40), 0.2);
  EXPECT_EQ(share_above(Histogram{}, 10), 0);
}

// A ramp of 0, 20, 40, ... from left to right: a contour is one pixel wide and lies on the brighter
// side. The step from 80 to 100 crosses 90; that from 60 to 80 crosses 70.
TEST(DisplayMeasures, ContoursOfARamp) {
  std::vector<uint8_t> values;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 8; ++x) values.push_back(uint8_t(20 * x));
  const Mask all(values.size(), 1);
  const auto row = ElementsAre(0, 0, 1, 0, 2, 3, 4, 5, 0, 0, 1, 0, 2, 3, 4, 5);
  EXPECT_THAT(contours(values, 8, all, kContourLevels), row);
}

// A step over several levels is the contour of the highest; a gap in the coverage hides it.
TEST(DisplayMeasures, ContoursOfAStepAndOverAGap) {
  const std::vector<uint8_t> values{0, 255, 255};
  EXPECT_THAT(contours(values, 3, {1, 1, 1}, kContourLevels), ElementsAre(0, 5, 0));
  EXPECT_THAT(contours(values, 3, {1, 0, 1}, kContourLevels), ElementsAre(0, 0, 0));
  EXPECT_THAT(contours(values, 1, {1, 1, 1}, kContourLevels), ElementsAre(0, 5, 0));
  const std::vector<uint8_t> below{0, 0, 255, 255};
  EXPECT_THAT(contours(below, 2, {1, 1, 1, 1}, kContourLevels), ElementsAre(0, 0, 5, 5));
}

// The last pixel of a row is no neighbour of the first of the next.
TEST(DisplayMeasures, ContoursDoNotGoOverTheEndOfARow) {
  const Mask all(4, 1);
  EXPECT_THAT(contours(std::vector<uint8_t>{255, 0, 255, 255}, 2, all, kContourLevels),
              ElementsAre(5, 0, 0, 5));
  EXPECT_THAT(contours(std::vector<uint8_t>{255, 255, 0, 255}, 2, all, kContourLevels),
              ElementsAre(5, 0, 0, 5));
}

}  // namespace
}  // namespace luxel::image
