// BMP and TGA: pixels known by hand, files that end early or lie.
#include <gmock/gmock.h>
#include <stb/stb_image_write.h>

#include <string>

#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void add_bytes(void* text, void* data, int size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(data), size_t(size));
}

Result<Image8> decoded(const std::string& file) {
  return decode_ldr(std::as_bytes(std::span(file.data(), file.size())), "pic");
}

std::vector<uint8_t> pixels_of(const std::string& file) {
  const auto image = decoded(file);
  EXPECT_TRUE(image) << image.error().message;
  return image ? image->data : std::vector<uint8_t>();
}

std::string raw(std::initializer_list<int> values) {
  std::string out;
  for (const int v : values) out += char(v);
  return out;
}

std::string le32(uint32_t v) {
  return raw({int(v & 255), int(v >> 8 & 255), int(v >> 16 & 255), int(v >> 24)});
}

/// A BMP with the oldest of Windows' headers. `between`: palette or masks.
std::string bmp(int width, int height, int bits, uint32_t packing, const std::string& between,
                const std::string& rows, uint32_t gap = 0) {
  const uint32_t start = 54 + uint32_t(between.size()) + gap;
  return "BM" + le32(0) + le32(0) + le32(start) + le32(40) + le32(uint32_t(width)) +
         le32(uint32_t(height)) + raw({1, 0, bits, 0}) + le32(packing) + le32(0) + le32(0) +
         le32(0) + le32(0) + le32(0) + between + std::string(gap, '\x7f') + rows;
}

/// A TGA of 2 x 1 pixels unless told otherwise, from the top down.
std::string tga(int kind, int bits, int flags, const std::string& rest, int palette_count = 0,
                int palette_bits = 0, int width = 2, int height = 1) {
  return raw({0, palette_count > 0, kind, 0, 0, palette_count, 0, palette_bits, 0, 0, 0, 0,
              width & 255, width >> 8, height & 255, height >> 8, bits, flags}) +
         rest;
}

constexpr int kTopDown = 0x20;
const std::vector<uint8_t> kThree{255, 0, 0, 255, 0, 128, 7, 64, 1, 2, 3, 4};  // 3 x 1 RGBA

TEST(DecodeBmpAndTga, WhatStbWritesComesBack) {
  std::string plain, runs;
  stbi_write_tga_with_rle = 0;
  stbi_write_tga_to_func(add_bytes, &plain, 3, 1, 4, kThree.data());
  stbi_write_tga_with_rle = 1;
  stbi_write_tga_to_func(add_bytes, &runs, 3, 1, 4, kThree.data());
  EXPECT_EQ(pixels_of(plain), kThree);
  EXPECT_EQ(pixels_of(runs), kThree);
  const std::vector<uint8_t> rows{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};  // 2 x 2 RGB
  std::string file;
  stbi_write_bmp_to_func(add_bytes, &file, 2, 2, 3, rows.data());
  EXPECT_THAT(pixels_of(file),
              ElementsAre(1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255));
}

TEST(DecodeBmpAndTga, KindsOfTga) {
  const std::string two = raw({3, 2, 1, 6, 5, 4});  // blue first
  EXPECT_THAT(pixels_of(tga(2, 24, kTopDown, two)), ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
  EXPECT_THAT(pixels_of(tga(3, 8, kTopDown, raw({9, 200}))),
              ElementsAre(9, 9, 9, 255, 200, 200, 200, 255));
  EXPECT_THAT(pixels_of(tga(1, 8, kTopDown, two + raw({1, 0}), 2, 24)),
              ElementsAre(4, 5, 6, 255, 1, 2, 3, 255));
  // Five bits each: 31 is 255.
  EXPECT_THAT(pixels_of(tga(2, 16, kTopDown, raw({0, 0x7c, 0xe0, 0x03}))),
              ElementsAre(255, 0, 0, 255, 0, 255, 0, 255));
  EXPECT_THAT(pixels_of(tga(10, 24, kTopDown, raw({0x81, 3, 2, 1}))),
              ElementsAre(1, 2, 3, 255, 1, 2, 3, 255));
  // From the bottom up, and with a text before the pixels.
  std::string upwards = tga(3, 8, 0, raw({'h', 'i', 10, 20}), 0, 0, 1, 2);
  upwards[0] = 2;
  EXPECT_THAT(pixels_of(upwards), ElementsAre(20, 20, 20, 255, 10, 10, 10, 255));
}

TEST(DecodeBmpAndTga, TheFourthByteCountsWhereTheFileSaysThatItIsAlpha) {
  const std::string pixels = raw({3, 2, 1, 0, 6, 5, 4, 100});
  EXPECT_THAT(pixels_of(tga(2, 32, kTopDown, pixels)), ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
  EXPECT_THAT(pixels_of(tga(2, 32, kTopDown | 8, pixels)), ElementsAre(1, 2, 3, 0, 4, 5, 6, 100));
}

TEST(DecodeBmpAndTga, KindsOfBmp) {
  const std::string colors = raw({3, 2, 1, 0, 6, 5, 4, 0});
  // Color 2 is none of the palette's: black, not what lay in memory.
  EXPECT_THAT(pixels_of(bmp(3, 1, 8, 0, colors, raw({1, 0, 2, 0}))),
              ElementsAre(4, 5, 6, 255, 1, 2, 3, 255, 0, 0, 0, 255));
  EXPECT_THAT(pixels_of(bmp(2, 1, 4, 0, colors, raw({0x10, 0, 0, 0}))),
              ElementsAre(4, 5, 6, 255, 1, 2, 3, 255));
  EXPECT_THAT(pixels_of(bmp(2, 1, 1, 0, colors, raw({0x80, 0, 0, 0}))),
              ElementsAre(4, 5, 6, 255, 1, 2, 3, 255));
  const std::string pixel = raw({3, 2, 1, 0});
  EXPECT_THAT(pixels_of(bmp(1, 1, 24, 0, "", pixel)), ElementsAre(1, 2, 3, 255));
  EXPECT_THAT(pixels_of(bmp(1, 1, 24, 0, "", pixel, 10)), ElementsAre(1, 2, 3, 255)) << "a gap";
  EXPECT_THAT(pixels_of(bmp(1, 1, 32, 0, "", pixel)), ElementsAre(1, 2, 3, 255)) << "no alpha";
  EXPECT_THAT(pixels_of(bmp(2, 1, 16, 3, le32(0xf800) + le32(0x07e0) + le32(0x001f),
                            raw({0, 0xf8, 0x1f, 0}))),
              ElementsAre(255, 0, 0, 255, 0, 0, 255, 255))
      << "masks";
  // Rows from the top down: a negative height.
  EXPECT_THAT(pixels_of(bmp(1, -2, 24, 0, "", raw({3, 2, 1, 0, 6, 5, 4, 0}))),
              ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
}

TEST(DecodeBmpAndTga, FilesThatEndEarlyAreRefused) {
  const std::string colors = raw({3, 2, 1, 0, 6, 5, 4, 0});
  for (const std::string& whole :
       {tga(2, 24, kTopDown, raw({3, 2, 1, 6, 5, 4})), tga(10, 24, 0, raw({0x81, 3, 2, 1})),
        tga(9, 8, 0, colors + raw({0x01, 0, 1}), 2, 32), bmp(3, 1, 8, 0, colors, "abcd"),
        bmp(2, 2, 24, 0, "", "abcdefgh12345678")}) {
    EXPECT_TRUE(decoded(whole));
    for (size_t length = 0; length < whole.size(); ++length)
      EXPECT_FALSE(decoded(whole.substr(0, length))) << length << " of " << whole.size();
  }
}

TEST(DecodeBmpAndTga, WhatTheyDoNotHoldIsSaid) {
  // Twenty bytes that state a gigabyte.
  EXPECT_THAT(decoded(tga(2, 32, 0, "ab", 0, 0, 16384, 16384)).error().message,
              HasSubstr("pic: the TGA picture ends early"));
  EXPECT_THAT(decoded(tga(2, 32, 0, "ab", 0, 0, 65535, 1)).error().message, HasSubstr("65535 x 1"));
  EXPECT_THAT(decoded(tga(2, 24, 0x10, "abcdef")).error().message,
              HasSubstr("runs from right to left"));
  const auto packed = decoded(bmp(4, 1, 8, 1, std::string(1024, 'a'), raw({4, 1, 0, 1})));
  EXPECT_EQ(packed.error().code, ErrorCode::unsupported);
  EXPECT_THAT(packed.error().message, HasSubstr("RLE; convert it to PNG"));
  const AllowSize none = [](uint32_t width, uint32_t) {
    return Status(fail(ErrorCode::out_of_memory, "{} are too many", width));
  };
  const std::string file = bmp(1, 1, 24, 0, "", "abcd");
  EXPECT_EQ(
      decode_ldr(std::as_bytes(std::span(file.data(), file.size())), "pic", none).error().code,
      ErrorCode::out_of_memory);
}

}  // namespace
}  // namespace luxel::image
