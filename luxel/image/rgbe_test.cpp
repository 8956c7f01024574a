// Pictures of light in 8 bits a channel, decoded here by the formulas of docs/format/bake.md.
#include "luxel/image/rgbe.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/image/rgbm.h"

namespace luxel::image {
namespace {

using Color = std::array<double, 3>;

/// E = range a rgb.
Color decode_rgbm(const Image8& picture, double range, size_t pixel) {
  const uint8_t* p = &picture.data[4 * pixel];
  const double a = p[3] / 255.0;
  return {range * a * (p[0] / 255.0), range * a * (p[1] / 255.0), range * a * (p[2] / 255.0)};
}

/// E = 255 rgb 2^(255 a - 136).
Color decode_rgbe(const Image8& picture, size_t pixel) {
  const uint8_t* p = &picture.data[4 * pixel];
  const double unit = std::exp2(255 * (p[3] / 255.0) - 136);
  return {unit * p[0], unit * p[1], unit * p[2]};
}

/// Light over nine powers of ten, some of it of one colour only, some none at all.
Image wild_image(uint64_t seed) {
  Image image(40, 25, 4);
  RandomStream random{seed};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float scale = std::pow(10.0f, 9 * random.next() - 5);
      image.set_rgb(x, y, {scale, scale * random.next(), x % 7 ? scale * random.next() : 0});
      image.at(x, y)[3] = 0.5f;
    }
  image.set_rgb(3, 3, {});
  image.set_rgb(4, 3, {0, 0, 2e4f});
  return image;
}

/// Through the PNG and back: what is not premultiplied there is not premultiplied here.
Image8 through_png(const Image8& picture) {
  const auto back = decode_ldr(encode_png(picture), "picture");
  EXPECT_TRUE(back);
  EXPECT_EQ(back->data, picture.data);
  return *back;
}

TEST(RgbmPicture, ErrsByHalfAStepOfItsMultiplier) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const Image image = wild_image(seed);
    const RgbmPicture rgbm = rgbm_picture(image);
    const Image8 picture = through_png(rgbm.picture);
    double worst = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Rgb c = image.rgb(x, y);
        const Color back = decode_rgbm(picture, double(rgbm.range), size_t(y * 40 + x));
        // The bound of rgbm.h, and a part in 10^9 for the doubles of this test.
        const double bound = (double(max_component(c)) + double(rgbm.range) / 255) / 510;
        for (int k = 0; k < 3; ++k) {
          const double error = std::abs(back[size_t(k)] - double(c[k]));
          EXPECT_LE(error, bound * (1 + 1e-9)) << x << " " << y;
          worst = std::max(worst, error / bound);
        }
      }
    EXPECT_GT(worst, 0.9) << "the bound is met, or it says too much";
  }
}

TEST(RgbmPicture, PeakIsWhiteDarkIsFineAndBlackIsZero) {
  Image image(5, 1, 3);
  image.set_rgb(0, 0, {100, 100, 50});
  image.set_rgb(1, 0, {});
  image.set_rgb(2, 0, {-3, 0, 0});
  image.set_rgb(3, 0, {100.0f / 256, 0, 0});            // the multiplier's smallest step
  image.set_rgb(4, 0, {100.0f / 255 / 255 / 3, 0, 0});  // a third of the smallest value
  const RgbmPicture rgbm = rgbm_picture(image);
  EXPECT_EQ(rgbm.range, 100);
  EXPECT_EQ(rgbm.picture.data, (std::vector<uint8_t>{255, 255, 128, 255, 0, 0, 0, 0, 0, 0,
                                                     0,   0,   254, 0,   0, 1, 0, 0, 0, 1}));
}

TEST(RgbmPicture, BlackHasRangeOne) {
  const RgbmPicture rgbm = rgbm_picture(Image(3, 2, 4));
  EXPECT_EQ(rgbm.range, 1);
  EXPECT_EQ(rgbm.picture.data, std::vector<uint8_t>(24));
}

TEST(RgbmPicture, TheRangeOfFloats) {
  for (const float largest : {1e-40f, 1e-20f, 3e38f}) {
    Image image(1, 1, 3);
    image.set_rgb(0, 0, {largest, largest / 2, 0});
    const RgbmPicture rgbm = rgbm_picture(image);
    EXPECT_TRUE(rgbm.range > 0 && std::isfinite(rgbm.range));
    const Color back = decode_rgbm(rgbm.picture, double(rgbm.range), 0);
    EXPECT_NEAR(back[0], double(largest), largest > 1e-30f ? double(largest) / 500 : 1e-30);
  }
}

TEST(RgbePicture, ErrsByOneIn256OfTheLargestComponent) {
  const Image image = wild_image(5);
  const Image8 picture = through_png(rgbe_picture(image));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgb c = image.rgb(x, y);
      const Color back = decode_rgbe(picture, size_t(y * 40 + x));
      // Eight bits below a power of two that is at most twice the largest component.
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(back[size_t(k)], double(c[k]), double(max_component(c)) / 256 * (1 + 1e-6));
    }
}

TEST(RgbePicture, HoldsTheNumbersOfTheHdrFile) {
  const Image image = wild_image(6);
  const Image hdr = *decode_hdr(encode_hdr(image), "hdr");
  const Image8 picture = rgbe_picture(image);
  for (size_t i = 0; i < size_t(image.width * image.height); ++i)
    for (size_t k = 0; k < 3; ++k)
      EXPECT_EQ(float(decode_rgbe(picture, i)[k]), hdr.data[3 * i + k]);
}

TEST(RgbePicture, KnownCodes) {
  EXPECT_EQ(to_rgbe({1, 0.5f, 0.25f}), (Rgbe{128, 64, 32, 129}));
  EXPECT_EQ(to_rgbe({}), Rgbe{});
  EXPECT_EQ(to_rgbe({-1, 0, 0}), Rgbe{});
  EXPECT_EQ(to_rgbe({0.99999f, 0, 0}), (Rgbe{128, 0, 0, 129})) << "rounds up to the next exponent";
}

}  // namespace
}  // namespace luxel::image
