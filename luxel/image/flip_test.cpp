#include "luxel/image/flip.h"

#include <gmock/gmock.h>

#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/image/color.h"
#include "luxel/image/flip_filters.h"

namespace luxel::image {
namespace {

constexpr int kPictureWidth = 64, kPictureHeight = 48;

template <class Function>
Image image_of(const Function& color_at, int width = kPictureWidth, int height = kPictureHeight) {
  Image image(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.set_rgb(x, y, color_at(x, y));
  return image;
}
Image uniform(Rgb color) {
  return image_of([&](int, int) { return color; });
}
/// A ramp per channel in display values, as linear light.
Image ramps() {
  return image_of([](int x, int y) {
    return Rgb{linear_from_srgb(float(x) / 63), linear_from_srgb(float(y) / 47),
               linear_from_srgb(float((x + 2 * y) % 16) / 15)};
  });
}
double mean(const Image& map) { return mean_over(map, Mask(map.data.size(), 1)); }

/// Output of tools/flip_reference.py, an evaluation of the papers' equations independent of luxel,
/// by dense two-dimensional convolutions in double precision.
struct Expected {
  double mean;
  std::array<double, 6> at;
};
constexpr std::array<std::array<int, 2>, 6> kFlipPixels{
    {{0, 0}, {32, 24}, {31, 19}, {24, 20}, {63, 47}, {40, 12}}};

/// luxel works in floats: the exponent 0.7 lifts a rounding of 1e-7 of a small difference to 1e-5.
void expect_map(const Image& map, const Expected& expected) {
  EXPECT_NEAR(mean(map), expected.mean, 2e-5);
  for (size_t i = 0; i < kFlipPixels.size(); ++i)
    EXPECT_NEAR(*map.at(kFlipPixels[i][0], kFlipPixels[i][1]), expected.at[i], 1e-4) << i;
}

TEST(Flip, AGreySquareOnRampsIsAsByDenseConvolution) {
  const Image b = ramps();
  Image a = b;
  for (int y = 20; y < 28; ++y)
    for (int x = 24; x < 40; ++x) a.set_rgb(x, y, {0.25f, 0.25f, 0.25f});
  expect_map(flip(a, b), {0.0241076, {0.000000, 0.328830, 0.307108, 0.320590, 0.000000, 0.007409}});
}

TEST(Flip, SwappedChannelsAreAsByDenseConvolution) {
  const Image b = ramps();
  const Image a = image_of([&](int x, int y) {
    const Rgb c = b.rgb(x, y);
    return Rgb{c.z, c.y, c.x};
  });
  expect_map(flip(a, b), {0.6028495, {0.286332, 0.360689, 0.340565, 0.565546, 0.798663, 0.144807}});
}

TEST(Flip, ACheckerAgainstItsMeanIsAsByDenseConvolution) {
  const Image a = image_of([](int x, int y) {
    const float v = (x / 4 + y / 4) % 2 ? 1.0f : 0.0f;
    return Rgb{v, v, v};
  });
  expect_map(flip(a, uniform({0.5f, 0.5f, 0.5f})),
             {0.4457188, {0.982530, 0.214949, 0.202243, 0.202243, 0.982530, 0.202243}});
}

TEST(HdrFlip, ABrightSpotIsAsByDenseConvolution) {
  const Image display = ramps();
  const Image b = image_of([&](int x, int y) {
    const Rgb c = display.rgb(x, y);
    const float spot = std::hypot(float(x - 40), float(y - 12)) < 3 ? 60.0f : 0.0f;
    const Rgb base{0.02f + spot, 0.02f + spot, 0.02f + spot};
    return base + c * c * c * 4;
  });
  const Image a = image_of([&](int x, int y) { return b.rgb(x, y) * 1.1f + Rgb{0, 0.05f, 0}; });
  const FlipExposures exposures = flip_exposures(b, Mask(kPictureWidth * kPictureHeight, 1));
  EXPECT_NEAR(exposures.start, -4.8321315, 1e-5);
  EXPECT_NEAR(exposures.stop, 2.9222541, 1e-5);
  EXPECT_EQ(exposures.count, 8);
  expect_map(hdr_flip(a, b, exposures),
             {0.6021991, {0.953794, 0.665581, 0.864706, 0.857270, 0.200484, 0.292930}});
}

// A million exposures would take an hour.
TEST(HdrFlip, StopsWhenAsked) {
  const Image grey = uniform({0.5f, 0.5f, 0.5f}), dark = uniform({0.2f, 0.2f, 0.2f});
  Progress progress;
  progress.begin("flip", uint64_t(kPictureHeight));
  const Image whole = flip(grey, dark, {.progress = &progress});
  EXPECT_EQ(progress.snapshot().done, uint64_t(kPictureHeight));
  progress.request_cancel();
  hdr_flip(grey, dark, {-4, 4, 1000000}, {.progress = &progress});
  EXPECT_EQ(progress.snapshot().done, uint64_t(kPictureHeight));
}

// The ranks of luminances, against sorting them.
TEST(FlipExposures, AreThoseOfTheBrightestAndTheMedian) {
  for (const size_t count : {size_t(1), size_t(2), size_t(kPictureWidth * kPictureHeight)}) {
    std::vector<float> sorted;
    Mask covered(kPictureWidth * kPictureHeight, 0);
    std::fill_n(covered.begin(), count, uint8_t(1));
    const Image image = image_of([&](int x, int y) {
      const uint64_t dice = hash64(uint64_t(x), uint64_t(y));
      const float v = std::exp2(float(dice % 1000) * 0.02f - 10) * (dice % 7 == 0 ? -1.0f : 1.0f);
      return Rgb{v, v, v};
    });
    for (size_t i = 0; i < count; ++i)
      sorted.push_back(
          std::max(luminance(image.rgb(int(i) % kPictureWidth, int(i) / kPictureWidth)), 0.0f));
    std::sort(sorted.begin(), sorted.end());
    const double median = 0.5 * (double(sorted[(count - 1) / 2]) + double(sorted[count / 2]));
    const FlipExposures found = flip_exposures(image, covered);
    if (!(median > 0)) continue;
    EXPECT_NEAR(found.stop - found.start, std::log2(double(sorted.back()) / median), 1e-9) << count;
  }
}

// Flat fields: no edges, no points, and filters of sum 1 change nothing. Black to white is 100 in
// lightness and nothing else; the largest distance is that from green to blue.
TEST(Flip, BlackAgainstWhiteInClosedForm) {
  const auto f = [](double t) {
    return t > 216.0 / 24389 ? std::cbrt(t) : t * 841 / 108 + 4.0 / 29;
  };
  const auto lab = [&](double x, double y, double z) {
    const double l = 116 * f(y) - 16;
    return std::array{l, 5 * l * (f(x) - f(y)), 2 * l * (f(y) - f(z))};
  };
  // XYZ of the primaries over the white's
  const auto green = lab(0.357591 / 0.950429, 0.715183, 0.119197 / 1.088900);
  const auto blue = lab(0.180450 / 0.950429, 0.072180, 0.950373 / 1.088900);
  const double largest = std::pow(
      std::abs(green[0] - blue[0]) + std::hypot(green[1] - blue[1], green[2] - blue[2]), 0.7);
  const double e = std::pow(100, 0.7);
  const double expected = 0.95 + (e - 0.4 * largest) / (0.6 * largest) * 0.05;
  const Image map = flip(uniform({1, 1, 1}), uniform({}));
  for (const float v : map.data) EXPECT_NEAR(v, expected, 1e-5);
  for (const float v : flip(uniform({0, 1, 0}), uniform({0, 0, 1})).data) EXPECT_NEAR(v, 1, 1e-5);
}

TEST(Flip, IsZeroForEqualImagesSymmetricAndInRange) {
  const Image a = ramps();
  const Image b = image_of([&](int x, int y) { return a.rgb(63 - x, 47 - y); });
  for (const float v : flip(a, a).data) EXPECT_EQ(v, 0);
  const Image ab = flip(a, b);
  EXPECT_EQ(ab.data, flip(b, a).data);
  for (const float v : ab.data) EXPECT_TRUE(v >= 0 && v <= 1) << v;
}

// A turn of both images turns the map. Sums run in another order then, and the exponent 0.7 lifts a
// rounding error of 1e-7 of a small difference to 1e-5.
TEST(Flip, HasNoPreferredDirection) {
  const Image a = ramps();
  const Image b = image_of([&](int x, int y) { return a.rgb(x, y) * (x > y ? 0.5f : 1.0f); });
  const auto turned = [](const Image& image) {
    return image_of([&](int x, int y) { return image.rgb(y, 47 - x); }, kPictureHeight,
                    kPictureWidth);
  };
  const Image map = flip(a, b), other = flip(turned(a), turned(b));
  for (int y = 0; y < kPictureWidth; ++y)
    for (int x = 0; x < kPictureHeight; ++x) EXPECT_NEAR(*other.at(x, y), *map.at(y, 47 - x), 2e-4);
}

TEST(Flip, ASmallerPixelIsSeenLess) {
  Image b = uniform({0.2f, 0.2f, 0.2f}), a = b;
  a.set_rgb(30, 20, {1, 1, 1});
  double last = 2;
  for (const double pixels_per_degree : {20.0, 67.0, 200.0}) {
    const double seen = *flip(a, b, {pixels_per_degree}).at(30, 20);
    EXPECT_LT(seen, last);
    last = seen;
  }
}

TEST(Flip, ThreadsAndBandsDoNotShow) {
  const Image a = ramps();
  const Image b = image_of([&](int x, int y) { return a.rgb((x + 5) % kPictureWidth, y); });
  const auto tall = [](const Image& image) {
    return image_of([&](int x, int y) { return image.rgb(x, y % kPictureHeight); }, kPictureWidth,
                    150);
  };
  const Image map = flip(tall(a), tall(b));
  {
    const ThreadLimit one(1);
    EXPECT_EQ(flip(tall(a), tall(b)).data, map.data);
  }
  // 150 rows are three bands, the picture repeats each 48 rows: row 64 + 8 is row 24 again
  for (int x = 0; x < kPictureWidth; ++x) EXPECT_EQ(*map.at(x, 72), *map.at(x, 24)) << x;
}

TEST(FlipFilters, SumsAndMomentsAreThoseOfTheGaussians) {
  const FlipFilters f = make_flip_filters(67.0206);
  const auto moment = [](const Kernel& k, int power) {
    double sum = 0;
    for (int x = -k.radius; x <= k.radius; ++x)
      sum += std::pow(x, power) * double(k.tap[size_t(x + k.radius)]);
    return sum;
  };
  for (const Kernel* k : {&f.achromatic, &f.red_green, &f.blue_yellow[0], &f.smooth}) {
    EXPECT_NEAR(moment(*k, 0), 1, 1e-6);
    EXPECT_NEAR(moment(*k, 1), 0, 1e-6);
  }
  // sigma^2 = b / (2 pi^2) degrees^2 = 1.0340^2 pixels^2
  EXPECT_NEAR(moment(f.achromatic, 2), 0.0047 / (2 * 9.8696044) * 67.0206 * 67.0206, 1e-4);
  EXPECT_NEAR(f.blue_yellow_weight[0] + f.blue_yellow_weight[1], 1, 1e-6);
  EXPECT_NEAR(moment(f.first, 0), 0, 1e-6);
  EXPECT_NEAR(moment(f.second, 0), 0, 1e-6);
  EXPECT_NEAR(moment(f.second, 1), 0, 1e-5);
}

TEST(FlipExposures, OfUniformBlackAndMasked) {
  const Image grey = uniform({2, 2, 2});
  const Mask all(kPictureWidth * kPictureHeight, 1);
  const FlipExposures one = flip_exposures(grey, all);
  EXPECT_DOUBLE_EQ(one.start, one.stop);
  EXPECT_EQ(one.count, 2);
  EXPECT_EQ(flip_exposures(uniform({}), all).count, 1);
  // The curve's inverse: 2 * 2^start comes out at 0.85.
  const double x = 2 * std::exp2(one.start);
  EXPECT_NEAR((0.9036 * x * x + 0.018 * x) / (0.8748 * x * x + 0.354 * x + 0.14), 0.85, 1e-6);
  // An uncovered lamp is not the brightest pixel; a median of zero does not ask for infinity.
  Image lamp = grey;
  lamp.set_rgb(0, 0, {500, 500, 500});
  Mask without = all;
  without[0] = 0;
  EXPECT_EQ(flip_exposures(lamp, without).start, one.start);
  Image dark = uniform({});
  dark.set_rgb(3, 3, {1, 1, 1});
  const FlipExposures many = flip_exposures(dark, all);
  EXPECT_NEAR(many.stop - many.start, 20, 1e-9);
  EXPECT_EQ(many.count, 20);
}

TEST(HdrFlip, IsZeroForEqualImagesAndTakesNegativeAndHugeValues) {
  Image b = image_of([](int x, int y) { return Rgb{float(x), float(y), 1e30f}; });
  b.set_rgb(1, 1, {-5, 0, 3e38f});
  const FlipExposures exposures = flip_exposures(b, Mask(kPictureWidth * kPictureHeight, 1));
  for (const float v : hdr_flip(b, b, exposures).data) EXPECT_EQ(v, 0);
  Image a = b;
  a.set_rgb(9, 9, {1, 2, -3});
  for (const float v : hdr_flip(a, b, exposures).data) EXPECT_TRUE(v >= 0 && v <= 1) << v;
}

// Light times a power of two, and all else the same: the exposures follow.
TEST(HdrFlip, DoesNotDependOnTheUnit) {
  const Image b = image_of([](int x, int y) { return Rgb{float(x + 1), float(y + 1), 3}; });
  const Image a = image_of([&](int x, int y) { return b.rgb(x, y) + Rgb{float(x % 3), 0, 0}; });
  const auto scaled = [](const Image& image) {
    return image_of([&](int x, int y) { return image.rgb(x, y) * 64; });
  };
  const Mask all(kPictureWidth * kPictureHeight, 1);
  const Image small = hdr_flip(a, b, flip_exposures(b, all));
  const Image large = hdr_flip(scaled(a), scaled(b), flip_exposures(scaled(b), all));
  EXPECT_NEAR(mean(small), mean(large), 1e-5);
  EXPECT_GT(mean(small), 0.05);
}

TEST(Flip, WhatIsNotCoveredDoesNotBleed) {
  const Image b = ramps();
  Image a = b;
  Mask covered(kPictureWidth * kPictureHeight, 1);
  for (int x = 0; x < kPictureWidth; ++x) {
    a.set_rgb(x, 20, {1, 0, 1});
    covered[size_t(20 * kPictureWidth + x)] = 0;
  }
  for (const float v : flip(with_uncovered_of(a, b, covered), b).data) EXPECT_EQ(v, 0);
}

}  // namespace
}  // namespace luxel::image
