#include "luxel/image/false_color.h"

#include <gmock/gmock.h>

#include <cmath>

#include "luxel/base/vec.h"
#include "luxel/image/color.h"

namespace luxel::image {
namespace {

using ::testing::ElementsAre;

/// CIE L*, another measure of lightness than the one the colours were made with.
double cie_lightness(Color8 c) {
  const auto linear = [&](size_t i) { return linear_from_srgb(float(c[i]) / 255); };
  return 116 * std::cbrt(double(luminance({linear(0), linear(1), linear(2)}))) - 16;
}

TEST(FalseColor, LightnessGrowsEvenly) {
  double last = cie_lightness(false_color(0));
  EXPECT_LT(last, 10);
  for (int i = 1; i <= 32; ++i) {
    const double now = cie_lightness(false_color(i / 32.0));
    EXPECT_GT(now - last, 1.0) << i;
    EXPECT_LT(now - last, 5.0) << i;
    last = now;
  }
  EXPECT_GT(last, 92);
}

TEST(FalseColor, IsColouredInTheMiddleAndClamped) {
  const Color8 middle = false_color(0.5);
  EXPECT_GT(middle[0], middle[1] + 80);  // red
  EXPECT_EQ(false_color(-3), false_color(0));
  EXPECT_EQ(false_color(7), false_color(1));
  EXPECT_EQ(false_color(NAN), false_color(0));
}

TEST(FalseColor, ContoursHaveColoursOfTheirOwn) {
  for (size_t i = 0; i < 5; ++i)
    for (size_t j = 0; j < i; ++j) {
      int distance = 0;
      for (size_t c = 0; c < 3; ++c)
        distance += std::abs(int(contour_color(i, 5)[c]) - contour_color(j, 5)[c]);
      EXPECT_GT(distance, 90) << i << " " << j;
    }
}

TEST(FalseColor, TheEmptyIsGreyAndTheRestIsNot) {
  Image map(3, 1, 1);
  map.data = {-1, 2, 5};
  const Image8 picture = draw_map(map, {1, 0, 1}, 0, 4);
  const Color8 low = false_color(0), high = false_color(1);
  EXPECT_THAT(picture.data,
              ElementsAre(low[0], low[1], low[2], 120, 120, 120, high[0], high[1], high[2]));
  EXPECT_THAT(draw_threshold(std::vector<uint8_t>{10, 11, 255}, 3, {1, 1, 0}, 10).data,
              ElementsAre(255, 255, 255, 0, 0, 0, 120, 120, 120));
  EXPECT_THAT(draw_covered({2, 1, 4, {1, 2, 3, 4, 5, 6, 7, 8}}, {1, 0}).data,
              ElementsAre(1, 2, 3, 120, 120, 120));
}

TEST(FalseColor, ContoursLieOverTheFadedPicture) {
  const Image8 picture =
      draw_contours(std::vector<uint8_t>{0, 5}, std::vector<uint8_t>{100, 200}, 2, {1, 1}, 5);
  const Color8 line = contour_color(4, 5);
  EXPECT_THAT(picture.data, ElementsAre(30, 30, 30, line[0], line[1], line[2]));
}

}  // namespace
}  // namespace luxel::image
