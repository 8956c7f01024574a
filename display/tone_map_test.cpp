#include "display/tone_map.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "image/color.h"

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

TEST(AutoExposure, SkipsEmptyPixels) {
  image::Image image = two_tones(50, 50, 1000, 3);
  for (int x = 0; x < 50; ++x) image.at(x, 0)[3] = 0;
  EXPECT_NEAR(auto_exposure(image), 0.2f, 1e-6f);
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

}  // namespace
}  // namespace luxel::display
