#include "luxel/image/white_level.h"

#include <gtest/gtest.h>

#include <vector>

namespace luxel::image {
namespace {

TEST(WhiteLevel, TheBrightestThousandthClips) {
  std::vector<Rgb> values(2001, Rgb{0.5f, 0.25f, 0});
  values[7] = {0, 90, 0};
  EXPECT_EQ(white_level(values), 0.5f);
  values[8] = values[9] = {0, 0, 80};  // three of 2001: more than a thousandth
  EXPECT_EQ(white_level(values), 80);
}

TEST(WhiteLevel, DarknessHasOneToo) {
  EXPECT_EQ(white_level(std::span<const Rgb>{}), 1);
  EXPECT_EQ(white_level(std::vector<Rgb>(5)), 1);
  std::vector<Rgb> values(5000);
  values[3] = {0, 0, 4};
  EXPECT_EQ(white_level(values), 4) << "the percentile is dark";
}

TEST(WhiteLevel, OfImagesCountsCoveredPixelsOnly) {
  std::vector<Image> pages(2, Image(3, 2, 4));
  pages[0].set_rgb(0, 0, {9, 9, 9});  // not covered
  EXPECT_EQ(white_level(pages), 1);
  pages[1].set_rgb(2, 1, {1, 2, 3}), pages[1].at(2, 1)[3] = 1;
  EXPECT_EQ(white_level(pages), 3);
}

}  // namespace
}  // namespace luxel::image
