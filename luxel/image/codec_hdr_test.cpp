// Radiance files written here byte by byte, after the description of the format, and damaged.
#include <gmock/gmock.h>

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Result<Image> decode(const std::string& file) {
  return decode_hdr(std::as_bytes(std::span(file.data(), file.size())), "pic.hdr");
}
std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::string bytes(std::initializer_list<int> values) {
  std::string out;
  for (const int v : values) out += char(uint8_t(v));
  return out;
}
std::string header(const std::string& size, const std::string& variables = "") {
  return "#?RADIANCE\n# made by hand\nFORMAT=32-bit_rle_rgbe\n" + variables + "\n" + size + "\n";
}
/// Mantissas 128, 64, 32 under the exponent 129: one half, a quarter and an eighth of 2.
std::string one_pixel() { return bytes({128, 64, 32, 129}); }

void expect_refused(const std::string& file, const std::string& words) {
  const auto image = decode(file);
  ASSERT_FALSE(image) << words;
  EXPECT_THAT(image.error().message, StartsWith("pic.hdr: "));
  EXPECT_THAT(image.error().message, HasSubstr(words));
}

TEST(Hdr, AFlatPixelIsMantissaTimesPowerOfTwo) {
  const auto image = decode(header("-Y 1 +X 2") + one_pixel() + bytes({255, 0, 1, 128 + 8}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 2);
  EXPECT_EQ(image->height, 1);
  EXPECT_EQ(image->channels, 3);
  EXPECT_EQ(image->rgb(0, 0), (Rgb{1, 0.5f, 0.25f}));
  EXPECT_EQ(image->rgb(1, 0), (Rgb{255, 0, 1}));
}

TEST(Hdr, ExponentZeroIsBlack) {
  EXPECT_EQ(decode(header("-Y 1 +X 1") + bytes({9, 9, 9, 0}))->rgb(0, 0), (Rgb{}));
}

// Red: a run of 5 and a dump of 3. The others: a run each.
TEST(Hdr, NewRuns) {
  const auto image = decode(header("-Y 1 +X 8") + bytes({2, 2, 0, 8, 128 + 5, 1, 3, 7, 8, 9,
                                                         128 + 8, 4, 128 + 8, 0, 128 + 8, 136}));
  ASSERT_TRUE(image) << image.error().message;
  for (int x = 0; x < 8; ++x)
    EXPECT_EQ(image->rgb(x, 0), (Rgb{float(x < 5 ? 1 : x + 2), 4, 0})) << x;
}

// A pixel, 3 more of it, another one; then a pixel and 2 + 256 of it: the second code in a row.
TEST(Hdr, OldRuns) {
  const auto image = decode(header("-Y 1 +X 264") + bytes({5, 6, 7, 136, 1, 1, 1, 3}) +
                            bytes({8, 8, 8, 136, 1, 1, 1, 2, 1, 1, 1, 1, 9, 9, 9, 136}));
  ASSERT_TRUE(image) << image.error().message;
  for (int x = 0; x < 264; ++x) {
    const Rgb expected = x < 4 ? Rgb{5, 6, 7} : x < 263 ? Rgb{8, 8, 8} : Rgb{9, 9, 9};
    EXPECT_EQ(image->rgb(x, 0), expected) << x;
  }
}

// Two scan lines of three pixels with red 1 .. 6; where each of them is to be seen.
TEST(Hdr, AllEightOrientations) {
  std::string pixels;
  for (int i = 1; i <= 6; ++i) pixels += bytes({i, 0, 0, 136});
  const auto reds = [&](const std::string& size) {
    const auto image = decode(header(size) + pixels);
    EXPECT_TRUE(image) << size;
    std::vector<int> out{image->width};
    for (size_t i = 0; i < image->data.size(); i += 3) out.push_back(int(image->data[i]));
    return out;
  };
  using testing::ElementsAre;
  EXPECT_THAT(reds("-Y 2 +X 3"), ElementsAre(3, 1, 2, 3, 4, 5, 6));
  EXPECT_THAT(reds("-Y 2 -X 3"), ElementsAre(3, 3, 2, 1, 6, 5, 4));
  EXPECT_THAT(reds("+Y 2 +X 3"), ElementsAre(3, 4, 5, 6, 1, 2, 3));
  EXPECT_THAT(reds("+Y 2 -X 3"), ElementsAre(3, 6, 5, 4, 3, 2, 1));
  EXPECT_THAT(reds("+X 2 -Y 3"), ElementsAre(2, 1, 4, 2, 5, 3, 6));
  EXPECT_THAT(reds("-X 2 -Y 3"), ElementsAre(2, 4, 1, 5, 2, 6, 3));
  EXPECT_THAT(reds("+X 2 +Y 3"), ElementsAre(2, 3, 6, 2, 5, 1, 4));
  EXPECT_THAT(reds("-X 2 +Y 3"), ElementsAre(2, 6, 3, 5, 2, 4, 1));
}

TEST(Hdr, ExposureAndColourCorrectionAreTakenBack) {
  const std::string variables = "EXPOSURE=2\nEXPOSURE= 0.25\nCOLORCORR=1 2 4\nGAMMA=1\n";
  const auto image = decode(header("-Y 1 +X 1", variables) + one_pixel());
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->rgb(0, 0), (Rgb{2, 0.5f, 0.125f}));
}

TEST(Hdr, BadHeadersAreSentences) {
  expect_refused("", "ends too early");
  expect_refused("hello\n", "not a Radiance HDR file");
  expect_refused("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "32-bit_rle_xyze");
  for (const char* size :
       {"", "-Y 1", "-Y 1 +Y 1", "-Y 0 +X 1", "-Y -3 +X 1", "Y 1 X 1", "-Z 1 +X 1"})
    expect_refused(header(size), "where its size should stand");
  expect_refused(header("-Y 70000 +X 1"), "claims 1 x 70000 pixels");
  expect_refused(header("-Y 60000 +X 60000"), "claims 60000 x 60000 pixels");
  for (const char* line : {"EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "EXPOSURE=\n",
                           "COLORCORR=1 2\n", "COLORCORR=1 inf 2\n"})
    expect_refused(header("-Y 1 +X 1", line) + one_pixel(), "does not hold positive numbers");
  expect_refused(header("-Y 1 +X 1", "EXPOSURE=1e-300\n") + one_pixel(), "too small");
}

TEST(Hdr, BadRunsAreSentences) {
  expect_refused(header("-Y 1 +X 8") + bytes({2, 2, 0, 8, 128 + 9, 1}),
                 "a run of 9 pixels where 8");
  expect_refused(header("-Y 1 +X 8") + bytes({2, 2, 0, 8, 0, 1}), "a run of 0");
  expect_refused(header("-Y 1 +X 4") + bytes({1, 1, 1, 3}), "3 repeated pixels");
  expect_refused(header("-Y 1 +X 4") + one_pixel() + bytes({1, 1, 1, 4}), "4 repeated pixels");
}

Image wild_image(int width, int height) {
  Image image(width, height, 3);
  RandomStream random{11};
  for (int y = 0; y < height; ++y) {
    Rgb c;
    for (int x = 0; x < width; ++x) {
      if (x % 11 == 0 || random.next() < 0.4f) {  // some runs, some not
        const float scale = std::exp2(60 * random.next() - 30);
        c = {scale * random.next(), scale * random.next(), scale * random.next()};
      }
      image.set_rgb(x, y, c);
    }
  }
  return image;
}

// Eight bits share the exponent of the largest channel: half a step is 2^-8 of it at the most.
TEST(Hdr, RoundTripIsWithinHalfAStep) {
  for (const int width : {1, 7, 8, 300}) {
    const Image image = wild_image(width, 9);
    const auto back = decode(text_of(encode_hdr(image)));
    ASSERT_TRUE(back) << back.error().message;
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < width; ++x) {
        const Rgb a = image.rgb(x, y), b = back->rgb(x, y);
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(a[c], b[c], max_component(a) / 256 * 1.0001f) << x << " " << y;
      }
    // Decoded pixels stay as they are when they are coded again.
    EXPECT_EQ(decode(text_of(encode_hdr(*back)))->data, back->data);
  }
}

TEST(Hdr, ExtremeValues) {
  Image image(4, 1, 3);
  image.set_rgb(0, 0, {3e38f, 1, 0});           // beyond what the format holds
  image.set_rgb(1, 0, {-4, 1, 1e-30f});         // negative light is none
  image.set_rgb(2, 0, {1e-40f, 0, 0});          // too dark for the format
  image.set_rgb(3, 0, {0.99999f, 0.5f, 0.5f});  // rounds up to the next exponent
  const auto back = decode(text_of(encode_hdr(image)));
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->rgb(0, 0).x, 1.7e38f, 1e36f);
  EXPECT_EQ(back->rgb(1, 0), (Rgb{0, 1, 0}));
  EXPECT_EQ(back->rgb(2, 0), (Rgb{}));
  EXPECT_EQ(back->rgb(3, 0), (Rgb{1, 0.5f, 0.5f}));
}

TEST(Hdr, LongRunsAreShort) { EXPECT_LT(encode_hdr(Image(1000, 100, 3)).size(), 100u * 80); }

TEST(Hdr, EveryTruncationIsRefused) {
  for (const int width : {5, 40}) {
    const std::string file = text_of(encode_hdr(wild_image(width, 6)));
    ASSERT_TRUE(decode(file));
    for (size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(decode(file.substr(0, length))) << length << " of " << file.size();
  }
}

TEST(Hdr, CorruptBytesNeverCrash) {
  const std::string good = text_of(encode_hdr(wild_image(40, 6)));
  RandomStream random{3};
  for (int i = 0; i < 3000; ++i) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k)
      bad[size_t(random.next() * float(bad.size()))] = char(random.next() * 255);
    const auto image = decode(bad);
    if (!image) {
      EXPECT_THAT(image.error().message, StartsWith("pic.hdr: "));
      continue;
    }
    for (const float v : image->data) ASSERT_TRUE(std::isfinite(v));
  }
}

}  // namespace
}  // namespace luxel::image
