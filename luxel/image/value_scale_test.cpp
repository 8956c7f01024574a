#include "luxel/image/value_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace luxel::image {
namespace {

std::vector<float> ramp(float low, float high, int count) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) out.push_back(low + (high - low) * float(i) / float(count - 1));
  return out;
}

TEST(ValueScale, HasTheLevelsOfTheStandard) {
  const ValueScale scale = scale_for(ramp(90, 700, 101), "lux");
  EXPECT_EQ(scale.top, 750);
  EXPECT_THAT(scale.levels, ::testing::ElementsAre(100, 150, 200, 300, 500));
  EXPECT_FALSE(scale.has_more);
}

// A patch of sun is a hundredth of the values: colours are for the others.
TEST(ValueScale, LeavesOutTheBrightestTwoPercent) {
  std::vector<float> values = ramp(90, 700, 200);
  values.push_back(60000);
  const ValueScale scale = scale_for(values, "lux");
  EXPECT_EQ(scale.top, 750);
  EXPECT_TRUE(scale.has_more);
  EXPECT_LE(scale.levels.size(), 10u);
}

TEST(ValueScale, HasMultiplesWhereValuesAreNearlyEven) {
  EXPECT_THAT(scale_for(ramp(430, 680, 51), "lux").levels,
              ::testing::ElementsAre(450, 500, 550, 600, 650));
  EXPECT_TRUE(scale_for(std::vector<float>(50, 0.0f), "lux").levels.empty());
  EXPECT_TRUE(scale_for(std::vector<float>(50, 3.0f), "lux").levels.size() <= 1);
}

// Values grow to the right: each isoline is one column, at the pixel before the level is reached,
// and does not cross into what is not finite or into another region.
TEST(ValueScale, DrawsIsolinesWhereLevelsAreCrossed) {
  constexpr int kWidth = 40, kHeight = 6;
  std::vector<float> values;
  std::vector<uint32_t> region;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      values.push_back(y == 0 ? std::numeric_limits<float>::quiet_NaN() : float(x));
      region.push_back(y == 5 && x > 20 ? 1u : 0u);
    }
  ValueScale scale;
  scale.top = 40, scale.levels = {20.5};
  const Image8 drawn = draw_values(values, kWidth, scale, {1, 2, 3}, region);
  const auto pixel = [&](int x, int y) {
    const uint8_t* p = drawn.data.data() + 3 * (y * kWidth + x);
    return Color8{p[0], p[1], p[2]};
  };
  const Color8 white{255, 255, 255};
  EXPECT_EQ(pixel(20, 0), (Color8{1, 2, 3}));
  EXPECT_EQ(pixel(20, 2), white);
  EXPECT_NE(pixel(19, 2), white);
  EXPECT_NE(pixel(21, 2), white);
  EXPECT_NE(pixel(20, 5), white);
}

TEST(ValueScale, TheLegendStandsBesideThePicture) {
  Image8 picture{30, 200, 3, std::vector<uint8_t>(size_t(3) * 30 * 200, 9)};
  ValueScale scale;
  scale.top = 100, scale.levels = {50}, scale.unit = "lux";
  const Image8 with = with_legend(picture, scale);
  EXPECT_EQ(with.height, 200);
  EXPECT_GT(with.width, 30 + text_of_value(100).size() * 6);
  EXPECT_EQ(with.data[0], 9);
  // The bar: dark below, bright above.
  const auto green = [&](int y) { return int(with.data[size_t(3 * (y * with.width + 45) + 1)]); };
  EXPECT_LT(green(175), 40);
  EXPECT_GT(green(45), 200);
}

}  // namespace
}  // namespace luxel::image
