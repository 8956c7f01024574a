#include "luxel/image/codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/team_test_support.h"
#include "luxel/image/color.h"

namespace luxel::image {
namespace {

/// Values over the whole range of finite floats: zeros of both signs, denormals, huge ones.
Image wild_image(int width, int height, int channels) {
  Image image(width, height, channels);
  RandomStream random{7};
  for (float& v : image.data) {
    const uint32_t bits = uint32_t(hash64(random.seed, random.index++));
    v = std::bit_cast<float>(bits);
    if (!std::isfinite(v)) v = 1.5f;
  }
  image.data.front() = -0.0f;
  image.data.back() = std::bit_cast<float>(1u);
  return image;
}

bool same_bits(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels &&
         std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0;
}

TEST(Exr, RoundTripKeepsEveryBit) {
  for (const int channels : {3, 4}) {
    const Image image = wild_image(37, 41, channels);
    const auto bytes = encode_exr(image);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const auto back = decode_exr(*bytes, "wild.exr");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_TRUE(same_bits(image, *back)) << channels;
  }
}

// Parts of 64 rows are compressed by all threads. The last has 13, less than a block of 16.
TEST(Exr, ManyPartsAreOneFile) {
  RandomStream random{6};
  Image image(30, 5 * 64 + 13, 3);
  for (float& v : image.data) v = random.next();
  const auto bytes = encode_exr(image);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto back = decode_exr(*bytes, "parts");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->height, image.height);
  EXPECT_EQ(back->data, image.data);
}

// A picture of noise: no two parts are alike.
TEST(Exr, IsCompressedByATeam) {
  RandomStream random{6};
  Image image(30, 5 * 64 + 13, 3);
  for (float& v : image.data) v = random.next();
  const auto expected = encode_exr(image);
  ASSERT_TRUE(expected);
  as_team(3, [&](Team& team) {
    Progress progress;
    const auto bytes = encode_exr_together(image, &team, progress);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ(*bytes, *expected);
  });
}

TEST(Exr, RowZeroIsOnTop) {
  // In the file, scan line blocks follow each other from the top: with increasing y, line 0 of the
  // data window is the top row, and the reader must not flip.
  Image image(2, 40, 3);
  image.set_rgb(0, 0, {1, 2, 3});
  image.set_rgb(1, 39, {4, 5, 6});
  const auto back = decode_exr(*encode_exr(image), "top.exr");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rgb(0, 0), (Rgb{1, 2, 3}));
  EXPECT_EQ(back->rgb(1, 39), (Rgb{4, 5, 6}));
}

TEST(Exr, EveryTruncationIsASentence) {
  const auto bytes = encode_exr(wild_image(7, 18, 4));  // two blocks of scan lines
  ASSERT_TRUE(bytes);
  for (size_t length = 0; length < bytes->size(); ++length) {
    const auto image = decode_exr(std::span(*bytes).first(length), "half.exr");
    ASSERT_FALSE(image) << length;
    EXPECT_THAT(image.error().message, testing::StartsWith("half.exr: "));
    EXPECT_EQ(image.error().code, ErrorCode::bad_input);
  }
}

TEST(Exr, CorruptBytesNeverCrash) {
  const auto good = encode_exr(wild_image(19, 33, 4));
  ASSERT_TRUE(good);
  RandomStream random{3};
  for (int i = 0; i < 400; ++i) {
    std::vector<std::byte> bytes = *good;
    for (int k = 0; k < 3; ++k)
      bytes[size_t(random.next() * float(bytes.size()))] = std::byte(random.next() * 255);
    const auto image = decode_exr(bytes, "bad.exr");
    if (!image) {
      EXPECT_THAT(image.error().message, testing::StartsWith("bad.exr: "));
    }
  }
}

// 22 bytes that would have 2 GB.
TEST(Exr, AnAttributeLongerThanTheFileIsRefused) {
  const std::string text("\x76\x2f\x31\x01\x02\0\0\0name\0type\0\xff\xff\xff\x7f", 22);
  const auto image = decode_exr(std::as_bytes(std::span(text)), "bomb.exr");
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, testing::HasSubstr("states 2147483647 bytes, and 0 are left"));
}

// Memory for 8 million pixels would be 134 MB.
TEST(Exr, MorePixelsThanTheBytesCanHoldAreRefusedBeforeMemoryIsTaken) {
  std::vector<std::byte> bytes = *encode_exr(Image(4, 4, 4));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::string_view kWindow("dataWindow\0box2i\0", 17);
  const size_t at = text.find(kWindow) + kWindow.size() + 4;  // its size, then x and y of both ends
  const int32_t right = (1 << 21) - 1;
  std::memcpy(bytes.data() + at + 8, &right, sizeof right);
  const auto image = decode_exr(bytes, "wide.exr");
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message,
              testing::HasSubstr("claims 2097152 x 4 pixels, more than its"));
}

TEST(Exr, MissingChannelIsNamed) {
  const auto bytes = encode_exr(Image(4, 4, 2));
  ASSERT_TRUE(bytes);
  const auto image = decode_exr(*bytes, "rg.exr");
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, testing::HasSubstr("no channel B"));
}

TEST(ExrDeathTest, NanAndInfinityAreBrokenContracts) {
  Image image(2, 2, 3);
  image.data[4] = NAN;
  EXPECT_DEATH((void)encode_exr(image), "isfinite");
  image.data[4] = INFINITY;
  EXPECT_DEATH((void)encode_exr(image), "isfinite");
}

TEST(Png, RoundTripThroughAnotherDecoder) {
  for (int channels = 1; channels <= 4; ++channels) {
    Image8 image{13, 7, channels, {}};
    RandomStream random{uint64_t(channels)};
    for (int i = 0; i < 13 * 7 * channels; ++i) image.data.push_back(uint8_t(random.next() * 256));
    const std::vector<std::byte> png = encode_png(image);
    int width = 0, height = 0, stored = 0;
    stbi_uc* back = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(png.data()),
                                          int(png.size()), &width, &height, &stored, 0);
    ASSERT_NE(back, nullptr);
    EXPECT_EQ(width, 13);
    EXPECT_EQ(height, 7);
    EXPECT_EQ(stored, channels);
    EXPECT_EQ(std::memcmp(back, image.data.data(), image.data.size()), 0);
    stbi_image_free(back);
  }
}

/// Bands of gradients and of noise: rows for each of PNG's filters.
Image8 banded(int width, int height, int channels) {
  RandomStream random{5};
  Image8 out{width, height, channels, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        out.data.push_back(y / 50 % 2 == 0 ? uint8_t(x + 2 * y + 40 * c)
                                           : uint8_t(random.next() * 9));
  return out;
}

// Strips of rows are compressed by all threads: another decoder puts them together.
TEST(Png, ManyStripsAreOneFileForAnyNumberOfThreads) {
  for (int channels = 1; channels <= 4; ++channels) {
    const Image8 image = banded(400, 700, channels);
    std::vector<std::byte> alone;
    {
      const ThreadLimit limit(1);
      alone = encode_png(image);
    }
    const ThreadLimit limit(7);
    const std::vector<std::byte> bytes = encode_png(image);
    EXPECT_EQ(bytes, alone);
    EXPECT_LT(2 * bytes.size(), image.data.size());
    int width = 0, height = 0, found = 0;
    uint8_t* pixels = stbi_load_from_memory(reinterpret_cast<const uint8_t*>(bytes.data()),
                                            int(bytes.size()), &width, &height, &found, 0);
    ASSERT_NE(pixels, nullptr);
    EXPECT_EQ((std::array{width, height, found}), (std::array{400, 700, channels}));
    EXPECT_TRUE(std::equal(image.data.begin(), image.data.end(), pixels));
    stbi_image_free(pixels);
  }
}

TEST(ToSrgb8, KnownValuesClampsAndLinearAlpha) {
  Image image(2, 1, 4);
  image.set_rgb(0, 0, {0, 0.21586f, 1});  // 0.21586 is the linear value of byte 128
  image.at(0, 0)[3] = 0.5f;
  image.set_rgb(1, 0, {-3, 1e30f, 0.0030353f});  // 0.0030353 = (10 / 255) / 12.92
  image.at(1, 0)[3] = 2;
  EXPECT_THAT(to_srgb8(image).data, testing::ElementsAre(0, 128, 255, 128, 0, 255, 10, 255));
}

TEST(ToSrgb8, InvertsTheDecoder) {
  Image image(256, 1, 3);
  for (int i = 0; i < 256; ++i) {
    const float v = linear_from_srgb(float(i) / 255);
    image.set_rgb(i, 0, {v, v, v});
  }
  const Image8 out = to_srgb8(image);
  for (int i = 0; i < 256; ++i) EXPECT_EQ(out.data[size_t(3 * i)], i);
}

}  // namespace
}  // namespace luxel::image
