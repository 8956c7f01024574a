// Halves decoded here by hand from sign, exponent and mantissa. [IEEE 754, binary16]
#include "luxel/image/half.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"

namespace luxel::image {
namespace {

double value_of(uint16_t bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  EXPECT_NE(exponent, 31) << "infinity or NaN";
  const double magnitude = exponent == 0 ? std::ldexp(double(mantissa), -24)
                                         : std::ldexp(double(1024 + mantissa), exponent - 25);
  return bits >> 15 ? -magnitude : magnitude;
}

TEST(Half, KeepsElevenBitsOverEightPowersOfTen) {
  Image image(200, 50, 3);
  RandomStream random{7};
  for (float& v : image.data) v = 3e5f * std::exp2(-28 * random.next());
  image.data[0] = 3e5f;  // a sunlit floor in lux: beyond the largest half
  const HalfImage half = to_half(image);
  double worst = 0;
  for (size_t i = 0; i < image.data.size(); ++i) {
    const double v = double(image.data[i]);
    worst = std::max(worst, std::abs(value_of(half.data[i]) * double(half.scale) - v) / v);
  }
  EXPECT_LE(worst, 0x1p-11);
  EXPECT_GT(worst, 0x1p-12);
  const double top = value_of(half.data[0]);
  EXPECT_GE(top, 0x1p14);
  EXPECT_LT(top, 0x1p15);
}

TEST(Half, FilesHaveAScaleOnlyWhereTheyNeedOne) {
  const auto scale = [](float largest) {
    Image image(1, 1, 3);
    image.set_rgb(0, 0, {0.01f * largest, largest, 0});
    return scale_for_files(std::span(&image, 1));
  };
  for (const float largest : {0.0f, 0.125f, 1.0f, 65504.0f}) EXPECT_EQ(scale(largest), 1);
  EXPECT_EQ(scale(0.0625f), 0x1p-18f);  // 2^-4 = 2^14 * scale
  EXPECT_EQ(scale(65536.0f), 4);
  Image bright(1, 1, 3);
  bright.set_rgb(0, 0, {70000, 1, 1});
  EXPECT_EQ(value_of(to_half(bright, 1).data[0]), 65504);
}

TEST(Half, EveryBitPatternIsRead) {
  for (uint32_t bits = 0; bits < 65536; ++bits)
    if ((bits >> 10 & 31) != 31) {
      ASSERT_EQ(double(from_half(uint16_t(bits))), value_of(uint16_t(bits)));
    }
}

TEST(Half, DarkerThanThatHasAFixedStep) {
  Image image(2, 1, 3);
  image.set_rgb(0, 0, {1, 0x1p-40f, 0x1.8p-39f});
  const HalfImage half = to_half(image);
  EXPECT_EQ(half.scale, 0x1p-14f);  // 1 = 2^14 * scale
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(value_of(half.data[size_t(k)]) * 0x1p-14, double(image.data[size_t(k)]),
                0x1p-25 * 0x1p-14);
}

TEST(Half, AlphaIsNotScaledAndBlackIsBlack) {
  Image image(1, 1, 4);
  image.at(0, 0)[3] = 0.5f;
  EXPECT_EQ(to_half(image).data, (std::vector<uint16_t>{0, 0, 0, 0x3800}));
  EXPECT_EQ(to_half(image).scale, 1);
  image.set_rgb(0, 0, {1e30f, 0, 0});
  EXPECT_EQ(to_half(image).data[3], 0x3800);
}

TEST(Half, TheRangeOfFloats) {
  for (const float v : {1e-42f, 1e-30f, 3.4e38f}) {
    Image image(1, 1, 3);
    image.set_rgb(0, 0, {v, v, v});
    const HalfImage half = to_half(image);
    EXPECT_TRUE(half.scale > 0 && std::isfinite(half.scale));
    EXPECT_NEAR(value_of(half.data[0]) * double(half.scale), double(v),
                std::max(v / 2048.0, 1e-37));
  }
}

}  // namespace
}  // namespace luxel::image
