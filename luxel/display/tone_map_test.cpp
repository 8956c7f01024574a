#include "luxel/display/tone_map.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/image/color.h"

namespace luxel::display {
namespace {

Rgb random_color(RandomStream& random, float largest) {
  return Rgb{random.next(), random.next(), random.next()} * largest;
}

TEST(Compress, BlackStaysBlackAndNegativeLightIsBlack) {
  EXPECT_EQ(compress({0, 0, 0}), (Rgb{0, 0, 0}));
  EXPECT_EQ(compress({-1, -2, -3}), (Rgb{0, 0, 0}));
}

TEST(Compress, LeavesDimColoursAlone) {
  RandomStream random{1};
  for (int i = 0; i < 1000; ++i) {
    const Rgb c = random_color(random, 0.5f), out = compress(c);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(out[k], c[k], 1e-6f);
  }
}

TEST(Compress, NeverClips) {
  RandomStream random{2};
  for (int i = 0; i < 1000; ++i) {
    const Rgb c = compress(random_color(random, std::pow(10.0f, float(i % 8))));
    EXPECT_LE(max_component(c), 1.0f);
    EXPECT_GE(min_component(c), 0.0f);
  }
  EXPECT_LT(compress({100, 100, 100}).x, 1);
  EXPECT_LT(compress({0, 0, 100}).z, 1);
}

TEST(Compress, EveryChannelGrowsWithExposure) {
  RandomStream random{3};
  for (int i = 0; i < 200; ++i) {
    const Rgb c = random_color(random, 1);
    Rgb before{};
    for (float exposure = 0.01f; exposure < 1000; exposure *= 1.1f) {
      const Rgb now = compress(c * exposure);
      for (int k = 0; k < 3; ++k) EXPECT_GE(now[k], before[k] - 1e-6f) << i << " at " << exposure;
      before = now;
    }
  }
}

TEST(Compress, HasNoKink) {
  // The slope along a ray of saturated blue and along grey: no jump between neighbours.
  for (const Rgb c : {Rgb{1, 1, 1}, Rgb{0, 0, 1}, Rgb{1, 0.2f, 0}}) {
    const float h = 1e-2f;
    for (float e = 0.1f; e < 5; e += h) {
      const float a = max_component(compress(c * e)), b = max_component(compress(c * (e + h)));
      const float d = max_component(compress(c * (e + 2 * h)));
      EXPECT_NEAR((b - a) / h, (d - b) / h, 0.06f) << c.z << " at " << e;
    }
  }
}

TEST(Compress, KeepsTheHue) {
  // Hue: the order of the channels and the ratio of their differences.
  RandomStream random{4};
  for (int i = 0; i < 500; ++i) {
    const Rgb c = random_color(random, 20), out = compress(c);
    const float mean_in = (c.x + c.y + c.z) / 3, mean_out = (out.x + out.y + out.z) / 3;
    const Vec3 in = normalize(c - Rgb{mean_in, mean_in, mean_in});
    const Vec3 now = normalize(out - Rgb{mean_out, mean_out, mean_out});
    if (length(out - Rgb{mean_out, mean_out, mean_out}) > 1e-3f) {
      EXPECT_GT(dot(in, now), 0.9999f) << i;
    }
  }
}

TEST(Compress, BrightColoursMoveToWhite) {
  const auto saturation = [](Rgb c) { return 1 - min_component(c) / max_component(c); };
  EXPECT_GT(saturation(compress({1, 0.1f, 0.1f})), saturation(compress({10, 1, 1})));
  EXPECT_LT(saturation(compress({1000, 100, 100})), 0.01f);
}

// Up to white, a colour is the one that it was: brown is no salmon, and red has no green or blue.
TEST(Compress, KeepsTheSaturation) {
  for (const Rgb c : {Rgb{0.139f, 0.048f, 0.015f}, Rgb{0.8f, 0, 0}, Rgb{0.1f, 0.2f, 1}})
    for (const float level : {0.3f, 0.7f, 1.0f}) {
      const Rgb in = c * (level / max_component(c)), out = compress(in);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(out[k] / max_component(out), in[k] / level, 1e-6f) << k << " at " << level;
    }
  // Lanterns keep a part of their colour, by 1 / (1 + 0.15 (m - 1)): 1.9 times of red over green.
  const Rgb lantern = compress({10, 1, 1});
  EXPECT_NEAR(1 - lantern.y / lantern.x, 0.9f / 2.35f, 1e-6f);
}

/// A luminance at several levels through a curve.
Rgb grey(float v) { return {v, v, v}; }

TEST(Curves, GrowWithExposureAndNeverLeaveTheScreen) {
  RandomStream random{5};
  for (const NamedToneMap& tone_map : kToneMaps)
    for (int i = 0; i < 200; ++i) {
      const Rgb c = random_color(random, 1);
      Rgb before = apply(tone_map.curve, {});
      EXPECT_EQ(before, Rgb{}) << tone_map.name;
      for (float exposure = 0.01f; exposure < 1000; exposure *= 1.1f) {
        const Rgb now = apply(tone_map.curve, c * exposure);
        EXPECT_LE(max_component(now), 1) << tone_map.name;
        for (int k = 0; k < 3; ++k) EXPECT_GE(now[k], before[k] - 1e-6f) << tone_map.name;
        before = now;
      }
    }
}

TEST(Curves, WhatIsNoLightIsBlackAndInfinityIsWhite) {
  const float nan = std::nanf("");
  for (const NamedToneMap& tone_map : kToneMaps) {
    EXPECT_EQ(apply(tone_map.curve, {-1, -2, -1e30f}), Rgb{}) << tone_map.name;
    EXPECT_EQ(apply(tone_map.curve, {nan, nan, nan}), Rgb{}) << tone_map.name;
    EXPECT_NEAR(apply(tone_map.curve, grey(INFINITY)).y, 1, 1e-5f) << tone_map.name;
  }
}

TEST(Curves, RatioIsTheHalfAtK) {
  for (const float k : {0.02f, 0.1f, 1.0f}) {
    const Rgb c = ratio_curve({k, 3 * k, 0}, k);
    EXPECT_FLOAT_EQ(c.x, 0.5f);
    EXPECT_FLOAT_EQ(c.y, 0.75f);
    EXPECT_EQ(c.z, 0);
    // k is an exposure.
    EXPECT_NEAR(ratio_curve(grey(0.3f), k).x,
                ratio_curve(grey(0.3f) * exposure_of_stops(std::log2(1 / double(k)))).x, 1e-6f);
  }
}

TEST(Curves, ReinhardReaches1AtItsWhitePointAndKeepsTheHue) {
  for (const float white : {1.0f, 4.0f, 20.0f}) {
    EXPECT_NEAR(reinhard_curve(grey(white), white).x, 1, 1e-6f);
    EXPECT_LT(reinhard_curve(grey(0.9f * white), white).x, 1);
  }
  EXPECT_FLOAT_EQ(reinhard_curve(grey(1), 4).y, (1 + 1.0f / 16) / 2);
  EXPECT_NEAR(reinhard_curve(grey(2), 1e6f).y, 2.0f / 3, 1e-6f) << "a far white: L / (1 + L)";
  const Rgb c = reinhard_curve({0.4f, 0.2f, 0.1f});
  EXPECT_NEAR(c.x / c.y, 2, 1e-5f);
  EXPECT_NEAR(c.y / c.z, 2, 1e-5f);
}

TEST(Curves, FilmicHasItsToeItsFitAndItsWhite) {
  EXPECT_NEAR(filmic_curve(grey(1)).x, 2.54f / 3.16f, 1e-6f);
  // 1 where 0.08 x^2 - 0.56 x - 0.14 = 0.
  const float white = (0.56f + std::sqrt(0.56f * 0.56f + 4 * 0.08f * 0.14f)) / 0.16f;
  EXPECT_NEAR(filmic_curve(grey(white)).x, 1, 1e-5f);
  EXPECT_LT(filmic_curve(grey(0.95f * white)).x, 1);
  EXPECT_LT(filmic_curve(grey(0.01f)).x / 0.01f, filmic_curve(grey(0.1f)).x / 0.1f) << "a toe";
}

TEST(Curves, AreFoundByName) {
  EXPECT_EQ(find_tone_map("filmic"), ToneMap::filmic);
  EXPECT_EQ(find_tone_map("Filmic"), std::nullopt);
  EXPECT_EQ(apply(ToneMap::shoulder, grey(3)), compress(grey(3)));
}

TEST(Exposure, AStopDoublesTheLight) {
  EXPECT_EQ(exposure_of_stops(0), 1);
  EXPECT_EQ(exposure_of_stops(1), 2);
  EXPECT_EQ(exposure_of_stops(-2), 0.25f);
  image::Image radiance(1, 1, 3);
  radiance.set_rgb(0, 0, grey(0.2f));
  const auto shown = [&](double stops) {
    const float v = float(tone_map(radiance, exposure_of_stops(stops), ToneMap::clamp).data[0]);
    return image::linear_from_srgb(v / 255);
  };
  EXPECT_NEAR(shown(0), 0.2f, 0.003f);
  EXPECT_NEAR(shown(1), 0.4f, 0.004f);
  EXPECT_NEAR(shown(2), 0.8f, 0.006f);
}

image::Image two_tones(int dark, int bright, float low, float high) {
  image::Image image(dark + bright, 1, 4);
  for (int x = 0; x < dark + bright; ++x) {
    const float v = x < dark ? low : high;
    image.set_rgb(x, 0, {v, v, v});
    image.at(x, 0)[3] = 1;
  }
  return image;
}

TEST(AutoExposure, BringsThe90thPercentileTo06) {
  image::Image ramp(1001, 1, 3);
  for (int x = 0; x <= 1000; ++x) ramp.set_rgb(x, 0, {float(x), float(x), float(x)});
  EXPECT_NEAR(auto_exposure(ramp) * 900, 0.6f, 1e-4f);
}

TEST(AutoExposure, TakesThePercentileThatItIsTold) {
  image::Image ramp(1001, 1, 3);
  for (int x = 0; x <= 1000; ++x) ramp.set_rgb(x, 0, {float(x), float(x), float(x)});
  EXPECT_NEAR(auto_exposure(ramp, 50) * 500, 0.6f, 1e-4f);
  EXPECT_NEAR(auto_exposure(ramp, 100) * 1000, 0.6f, 1e-4f);
  EXPECT_NEAR(auto_exposure(ramp, 0) * 1, 0.6f, 1e-4f) << "black at 0: the least that is not";
}

TEST(AutoExposure, SkipsEmptyPixels) {
  image::Image image = two_tones(50, 50, 1000, 3);
  for (int x = 0; x < 50; ++x) image.at(x, 0)[3] = 0;
  EXPECT_NEAR(auto_exposure(image), 0.2f, 1e-6f);
}

// A picture of nothing, or of what is black, shows the sky behind it.
TEST(AutoExposure, IsForTheSkyWhereNoSurfaceHasLight) {
  image::Image image = two_tones(50, 50, 1000, 0);
  for (int x = 0; x < 50; ++x) image.at(x, 0)[3] = 0;
  EXPECT_NEAR(auto_exposure(image), 0.6f / 1000, 1e-9f);
  for (int x = 50; x < 100; ++x) image.at(x, 0)[3] = 0;
  EXPECT_NEAR(readable_exposure(image), 0.6f / 1000, 1e-9f);
}

TEST(AutoExposure, BlackPicturesAndNearlyBlackOnes) {
  EXPECT_EQ(auto_exposure(image::Image(8, 8, 4)), 1);
  EXPECT_EQ(auto_exposure(two_tones(10, 10, 0, 0)), 1);
  EXPECT_NEAR(auto_exposure(two_tones(99, 1, 0, 6)), 0.1f, 1e-6f);
}

TEST(ToneMap, WritesThreeChannelsOfSrgb) {
  image::Image radiance(2, 1, 4);
  radiance.set_rgb(0, 0, {0.1f, 0.2f, 0.05f});
  const image::Image8 out = tone_map(radiance, 2);
  ASSERT_EQ(out.channels, 3);
  ASSERT_EQ(out.data.size(), 6u);
  EXPECT_EQ(out.data[0], int(std::round(255 * image::srgb_from_linear(0.2f))));
  EXPECT_EQ(out.data[1], int(std::round(255 * image::srgb_from_linear(0.4f))));
  EXPECT_EQ(out.data[5], 0);
}

/// 20 x 20 pixels, the first `share` of them at one level, the rest at another.
image::Image two_levels(float share, float first, float rest) {
  image::Image picture(20, 20, 3);
  for (int i = 0; i < 400; ++i) {
    const float v = i < int(share * 400 + 0.5f) ? first : rest;
    picture.set_rgb(i % 20, i / 20, {v, v, v});
  }
  return picture;
}

// Nothing is hard to read in a picture of low contrast.
TEST(ReadableExposure, IsThatOfTheBrightPartWhereContrastIsLow) {
  for (const auto& picture : {two_levels(1, 3, 3), two_levels(0.3f, 9, 3), two_levels(0.7f, 9, 3)})
    EXPECT_FLOAT_EQ(readable_exposure(picture), auto_exposure(picture));
}

// The sun on 15 % of a room's floor, a hundred times as bright as its walls: their log mean is
// 100^0.15, shown at 0.15. The walls can be read, and the sun is not more than white.
TEST(ReadableExposure, ShowsARoomWithASunPatch) {
  const image::Image picture = two_levels(0.15f, 100, 1);
  const float e = readable_exposure(picture);
  EXPECT_NEAR(e, 0.15f / std::pow(100.0f, 0.15f), 1e-5f);
  EXPECT_GT(e, 10 * auto_exposure(picture));
  EXPECT_LT(compress(Rgb{100, 100, 100} * e).x, 0.97f);
}

// However dark the rest, the bright part is shown at 8 before the shoulder at most.
TEST(ReadableExposure, StopsBeforeTheBrightPartIsWhite) {
  EXPECT_FLOAT_EQ(readable_exposure(two_levels(0.15f, 300, 1)), 8.0f / 300);
}

// Lamps in the night: what is black beside them stays black.
TEST(ReadableExposure, LeavesTheNightDark) {
  EXPECT_FLOAT_EQ(readable_exposure(two_levels(0.15f, 1, 1e-4f)), 0.6f);
  EXPECT_FLOAT_EQ(readable_exposure(two_levels(0.15f, 1, 0)), 0.6f);
  EXPECT_EQ(readable_exposure(two_levels(1, 0, 0)), 1);
}

TEST(ReadableExposure, DoesNotDependOnTheUnitOfLight) {
  EXPECT_NEAR(readable_exposure(two_levels(0.15f, 1e5f, 1e3f)) * 1e3f,
              readable_exposure(two_levels(0.15f, 100, 1)), 1e-5f);
}

}  // namespace
}  // namespace luxel::display
