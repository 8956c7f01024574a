#include "luxel/image/e8r8g8b8.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "luxel/base/random.h"

namespace luxel::image {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The worst component's error over the largest component.
double relative_error(Rgb c) {
  const Rgb back = from_e8r8g8b8(to_e8r8g8b8(c));
  double worst = 0;
  for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(double(back[k]) - double(c[k])));
  return worst / double(max_component(c));
}

TEST(E8R8G8B8, RoundTripsWithin1In256OfTheLargestComponent) {
  RandomStream random{1};
  for (int e = -128; e < 127; ++e)
    for (int i = 0; i < 200; ++i) {
      const float largest = std::ldexp(1 + random.next(), e);
      EXPECT_LE(relative_error({largest, largest * random.next(), largest * random.next()}),
                1.0 / 256 * (1 + 1e-6))
          << e << " " << i;
    }
}

// Where one range gives way to the next, the bound is met and would be missed by the paper's ceil.
TEST(E8R8G8B8, TheBoundHoldsWhereTheRangeChanges) {
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const float largest = 0.5f + float(i) * 1e-6f;
    for (const float share : {0.1f, 0.4999f, 0.501f, 0.99f})
      worst = std::max(worst, relative_error({largest, largest * share, 0}));
  }
  EXPECT_LE(worst, 1.0 / 256 * (1 + 1e-6));
  EXPECT_GE(worst, 1.0 / 257);
}

TEST(E8R8G8B8, PowersOfTwoAreExactAndLayoutIsDirect3Ds) {
  for (int e = -128; e <= 127; ++e) {
    const float v = std::ldexp(1.0f, e);
    EXPECT_EQ(from_e8r8g8b8(to_e8r8g8b8({v, 0, v})), (Rgb{v, 0, v})) << e;
  }
  // 2 = 255/255 * 2^1, 1 = 128/255 of it, as near as a byte gets.
  EXPECT_EQ(to_e8r8g8b8({2, 1, 0}), (E8R8G8B8{129, 255, 128, 0}));
  EXPECT_EQ(pack({129, 255, 128, 0}), 0x81ff8000u);
  EXPECT_EQ(unpack_e8r8g8b8(0x81ff8001u), (E8R8G8B8{129, 255, 128, 1}));
}

TEST(E8R8G8B8, TheLampOfPlateC10) {
  const Rgb back = from_e8r8g8b8(to_e8r8g8b8({100.4f, 96.8f, 90.0f}));
  EXPECT_NEAR(back.x, 100.4f, 128.0f / 510);
  EXPECT_NEAR(back.y, 96.8f, 128.0f / 510);
  EXPECT_NEAR(back.z, 90.0f, 128.0f / 510);
}

TEST(E8R8G8B8, WhatHasNoPlace) {
  EXPECT_EQ(to_e8r8g8b8({0, 0, 0}), E8R8G8B8{});
  EXPECT_EQ(to_e8r8g8b8({-0.0f, -1, -kInfinity}), E8R8G8B8{});
  EXPECT_EQ(to_e8r8g8b8({kNan, kNan, kNan}), E8R8G8B8{});
  EXPECT_EQ(from_e8r8g8b8(E8R8G8B8{}), Rgb{});
  EXPECT_EQ(to_e8r8g8b8({1e-45f, 0, 0}), E8R8G8B8{}) << "under half a step of the last range";
  const Rgb mixed = from_e8r8g8b8(to_e8r8g8b8({1, -5, kNan}));
  EXPECT_EQ(mixed, (Rgb{1, 0, 0}));
  for (const float v : {kInfinity, std::numeric_limits<float>::max(), 0x1.8p127f})
    EXPECT_EQ(from_e8r8g8b8(to_e8r8g8b8({v, 1, 0})), (Rgb{0x1p127f, 0, 0}));
}

TEST(E8R8G8B8, EveryCodeIsFinite) {
  for (int e = 0; e < 256; ++e)
    for (const int v : {0, 1, 127, 128, 255})
      EXPECT_TRUE(is_finite(from_e8r8g8b8({uint8_t(e), uint8_t(v), 255, 0})));
}

TEST(E8R8G8B8, Images) {
  Image image(2, 1, 4);
  image.set_rgb(0, 0, {1, 2, 4});
  image.set_rgb(1, 0, {0, 0.5f, 0});
  const Image back = decode_e8r8g8b8(encode_e8r8g8b8(image), 2, 1);
  ASSERT_EQ(back.channels, 3);
  EXPECT_NEAR(back.rgb(0, 0).x, 1, 4.0f / 256);
  EXPECT_EQ(back.rgb(0, 0).z, 4);
  EXPECT_EQ(back.rgb(1, 0), (Rgb{0, 0.5f, 0}));
}

}  // namespace
}  // namespace luxel::image
