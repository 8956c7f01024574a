#include "luxel/image/compare.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::image {
namespace {

using ::testing::HasSubstr;

Image uniform(int width, int height, Rgb color, float alpha = -1) {
  Image image(width, height, alpha < 0 ? 3 : 4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      image.set_rgb(x, y, color);
      if (alpha >= 0) image.at(x, y)[3] = alpha;
    }
  return image;
}

Image noise(int width, int height, int channels, uint64_t seed) {
  Image image(width, height, channels);
  RandomStream random{seed};
  for (float& v : image.data) v = random.next();
  if (channels == 4)
    for (size_t i = 3; i < image.data.size(); i += 4) image.data[i] = 1;
  return image;
}

Difference measured(const Image& a, const Image& b) {
  const auto d = compare(a, "a", b, "b");
  EXPECT_TRUE(d) << d.error().message;
  return d.value_or(Difference{});
}
std::string refused(const Image& a, const Image& b) {
  const auto d = compare(a, "one.exr", b, "two.exr");
  EXPECT_FALSE(d);
  return d ? "" : d.error().message;
}

TEST(Compare, EqualImagesDifferByNothing) {
  for (const float value : {0.0f, 0.7f}) {
    const Image image = uniform(5, 4, {value, value, value});
    const Difference d = measured(image, image);
    EXPECT_EQ(d.texels, 20u);
    EXPECT_EQ(d.rmse, 0);
    EXPECT_EQ(d.rmse_over_mean, 0);
    EXPECT_EQ(d.relative_rmse, 0);
    EXPECT_EQ(d.max_abs, 0);
    EXPECT_EQ(d.bias_over_mean, 0);
    EXPECT_EQ(d.psnr_db, std::numeric_limits<double>::infinity());
  }
}

// a = b + 1/4 with b = 1/2 everywhere: every mean is known, with values exact in binary.
TEST(Compare, AConstantOffset) {
  const Difference d =
      measured(uniform(7, 3, {0.75f, 0.75f, 0.75f}), uniform(7, 3, {0.5f, 0.5f, 0.5f}));
  EXPECT_DOUBLE_EQ(d.mean, 0.5);
  EXPECT_DOUBLE_EQ(d.rmse, 0.25);
  EXPECT_DOUBLE_EQ(d.rmse_over_mean, 0.5);
  EXPECT_DOUBLE_EQ(d.relative_rmse, 0.25 / 0.505);  // 0.5 + 0.01 * 0.5
  EXPECT_DOUBLE_EQ(d.mean_abs, 0.25);
  EXPECT_DOUBLE_EQ(d.max_abs, 0.25);
  EXPECT_EQ(d.max_at, (std::array{0, 0}));  // the first of equals
  EXPECT_DOUBLE_EQ(d.bias, 0.25);
  EXPECT_DOUBLE_EQ(d.bias_over_mean, 0.5);
  EXPECT_DOUBLE_EQ(d.peak, 0.5);
  EXPECT_DOUBLE_EQ(d.psnr_db, 20 * std::log10(2.0));
}

// Channels differ by +1/2, -1/4 and 0: the bias cancels in part, the absolute error does not.
TEST(Compare, ChannelsAreOneMean) {
  const Difference d = measured(uniform(2, 2, {1.5f, 0.75f, 1}), uniform(2, 2, {1, 1, 1}));
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt((0.25 + 0.0625) / 3));
  EXPECT_DOUBLE_EQ(d.mean_abs, 0.25);
  EXPECT_DOUBLE_EQ(d.bias, 0.25 / 3);
  EXPECT_DOUBLE_EQ(d.max_abs, 0.5);
  EXPECT_DOUBLE_EQ(d.relative_rmse, std::sqrt((0.25 + 0.0625) / 3) / 1.01);
}

// One channel of one of 100 pixels is off by 3.
TEST(Compare, OnePixelOff) {
  Image b = uniform(10, 10, {2, 2, 2}), a = b;
  a.at(6, 8)[1] = -1;
  const Difference d = measured(a, b);
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(9.0 / 300));
  EXPECT_DOUBLE_EQ(d.bias, -3.0 / 300);
  EXPECT_DOUBLE_EQ(d.max_abs, 3);
  EXPECT_EQ(d.max_at, (std::array{6, 8}));
  EXPECT_DOUBLE_EQ(d.psnr_db, 10 * std::log10(4 * 300 / 9.0));
  const Mask all(100, 1);
  const Image map = relative_error_map(a, b, all, d.mean);
  EXPECT_FLOAT_EQ(*map.at(6, 8), float(3 / 2.02 / std::sqrt(3.0)));
  EXPECT_EQ(*map.at(5, 8), 0);
  EXPECT_NEAR(mean_over(map, all), double(*map.at(6, 8)) / 100, 1e-17);
  EXPECT_EQ(quantile_over(map, all, 0.5), 0);
  EXPECT_EQ(quantile_over(map, all, 1), double(*map.at(6, 8)));
}

// The mean of the squares of the map is the square of the measure. The map is rounded to floats,
// and so are their squares: 2^-24 each, which may not cancel.
TEST(Compare, TheMapIsTheMeasure) {
  const Image a = noise(31, 17, 3, 1), b = noise(31, 17, 3, 2);
  const Difference d = measured(a, b);
  const Mask all(31 * 17, 1);
  Image map = relative_error_map(a, b, all, d.mean);
  for (float& v : map.data) v *= v;
  EXPECT_NEAR(std::sqrt(mean_over(map, all)), d.relative_rmse, 3e-7 * d.relative_rmse);
}

// Black under a light A: nothing to divide by but the mean of the rest, and then not even that.
TEST(Compare, ABlackReference) {
  const Difference d = measured(uniform(3, 3, {1, 1, 1}), uniform(3, 3, {}));
  EXPECT_EQ(d.rmse, 1);
  EXPECT_EQ(d.rmse_over_mean, std::numeric_limits<double>::infinity());
  EXPECT_EQ(d.relative_rmse, std::numeric_limits<double>::infinity());
  EXPECT_EQ(d.bias_over_mean, std::numeric_limits<double>::infinity());
}

TEST(Compare, OnlyWhatBothCoverCounts) {
  Image a = uniform(4, 1, {1, 1, 1}, 1), b = a;
  a.set_rgb(0, 0, {9, 9, 9}), a.at(0, 0)[3] = 0.5f;  // dilated in a
  b.set_rgb(1, 0, {-7, 0, 0}), b.at(1, 0)[3] = 0;    // empty in b
  a.set_rgb(2, 0, {1.5f, 1.5f, 1.5f});
  const Difference d = measured(a, b);
  EXPECT_EQ(d.texels, 2u);
  EXPECT_DOUBLE_EQ(d.mean, 1);
  EXPECT_DOUBLE_EQ(d.rmse, 0.5 / std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(d.bias, 0.25);
}

TEST(Compare, WhatCannotBeComparedIsASentence) {
  const Image b = uniform(4, 3, {1, 1, 1});
  EXPECT_THAT(refused(uniform(3, 4, {}), b),
              HasSubstr("one.exr has 3 x 4 pixels and two.exr has 4"));
  EXPECT_THAT(refused(uniform(4, 3, {}, 1), b), HasSubstr("4 channels and two.exr has 3"));
  EXPECT_THAT(refused(Image(4, 3, 1), Image(4, 3, 1)), HasSubstr("1 channels"));
  Image bad = b;
  bad.at(2, 1)[0] = NAN;
  EXPECT_THAT(refused(bad, b), HasSubstr("one.exr: pixel (2, 1) is nan"));
  bad.at(2, 1)[0] = -INFINITY;
  EXPECT_THAT(refused(b, bad), HasSubstr("two.exr: pixel (2, 1) is -inf"));
  const Image none = uniform(4, 3, {1, 1, 1}, 0.5f);
  EXPECT_THAT(refused(none, uniform(4, 3, {1, 1, 1}, 1)), HasSubstr("no pixel in common"));
}

// Sums of many small numbers do not drift, and threads do not change a bit. A million equal numbers
// summed in double, first rows of 3072 and then 1024 of them: 4096 roundings of 1e-16 at most.
TEST(Compare, SumsAreExactEnoughAndTheSameForAnyThreads) {
  const Image a = uniform(1024, 1024, {1.1f, 1.1f, 1.1f}), b = uniform(1024, 1024, {1, 1, 1});
  EXPECT_NEAR(measured(a, b).bias, double(1.1f) - 1, 4e-14);
  const Image na = noise(300, 200, 4, 1), nb = noise(300, 200, 4, 2);
  const Difference many = measured(na, nb);
  const ThreadLimit one(1);
  const Difference single = measured(na, nb);
  EXPECT_EQ(many.rmse, single.rmse);
  EXPECT_EQ(many.bias, single.bias);
  EXPECT_EQ(many.relative_rmse, single.relative_rmse);
}

// The difference of two independent uniform variables on [0, 1]: variance 1/6, mean of |d| 1/3,
// mean of d^4 1/15. Of n = 786,432 values the root mean square is known to
// sqrt(1/15 - 1/36) / (2 sqrt(1/6) sqrt(n)) = 2.7e-4, the mean of |d| to sqrt(1/6 - 1/9) / sqrt(n)
// = 2.7e-4 and the bias to sqrt(1/6) / sqrt(n) = 4.6e-4; four of each.
TEST(Compare, NoiseHasItsKnownMoments) {
  const Difference d = measured(noise(512, 512, 3, 5), noise(512, 512, 3, 6));
  EXPECT_NEAR(d.rmse, std::sqrt(1.0 / 6), 0.0011);
  EXPECT_NEAR(d.mean_abs, 1.0 / 3, 0.0011);
  EXPECT_NEAR(d.bias, 0, 0.0019);
}

}  // namespace
}  // namespace luxel::image
