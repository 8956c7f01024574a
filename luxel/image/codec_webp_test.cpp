// Pictures written by libwebp's encoder, then damaged; and headers that lie about the size.
#include <gmock/gmock.h>
#include <webp/encode.h>

#include <string>

#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

using ::testing::HasSubstr;

/// 5 x 3 pixels, no two alike, the last of them half transparent.
std::vector<uint8_t> pixels() {
  std::vector<uint8_t> rgba;
  for (uint8_t i = 0; i < 15; ++i)
    for (const int c : {17 * i, 255 - 9 * i, i * i, i == 14 ? 128 : 255})
      rgba.push_back(uint8_t(c));
  return rgba;
}

std::string webp(bool lossless) {
  uint8_t* bytes = nullptr;
  const size_t size = lossless ? WebPEncodeLosslessRGBA(pixels().data(), 5, 3, 20, &bytes)
                               : WebPEncodeRGBA(pixels().data(), 5, 3, 20, 90, &bytes);
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

Result<Image8> decoded_webp(const std::string& file) {
  return decode_ldr(std::as_bytes(std::span(file.data(), file.size())), "pic");
}

TEST(DecodeWebp, LosslessComesBackExactly) {
  const auto image = decoded_webp(webp(true));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 5);
  EXPECT_EQ(image->height, 3);
  EXPECT_EQ(image->data, pixels());
  const std::string file = webp(true);
  const auto display = decode_display(std::as_bytes(std::span(file.data(), file.size())), "pic");
  ASSERT_TRUE(display);
  for (size_t i = 0; i < display->data.size(); ++i)
    EXPECT_EQ(display->data[i], float(pixels()[i]) / 255.0f);
}

TEST(DecodeWebp, EveryTruncationIsRefused) {
  for (const std::string& file : {webp(true), webp(false)}) {
    EXPECT_TRUE(decoded_webp(file));
    for (size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(decoded_webp(file.substr(0, length))) << length << " of " << file.size();
  }
}

// Pixels may change, for WebP has no checksums; what counts is that there is a result: a picture
// as large as its pixels, or a sentence that names the file. The first twelve bytes are a
// signature.
TEST(DecodeWebp, FlippedBitsGiveAResult) {
  for (const std::string& good : {webp(true), webp(false)})
    for (size_t i = 0; i < good.size(); ++i)
      for (const uint8_t bits : {0x01, 0x80, 0xff}) {
        std::string bad = good;
        bad[i] = char(uint8_t(bad[i]) ^ bits);
        const auto image = decoded_webp(bad);
        if (image) {
          EXPECT_EQ(image->data.size(), size_t(image->width) * size_t(image->height) * 4) << i;
          EXPECT_FALSE(i < 4 || (i >= 8 && i < 12)) << "byte " << i << " is of the signature";
        } else {
          EXPECT_THAT(image.error().message, HasSubstr("pic")) << i;
        }
      }
}

std::string big_endian(uint32_t value) {
  std::string text;
  for (const int shift : {24, 16, 8, 0}) text += char(value >> shift & 255);
  return text;
}
std::string png_chunk(const std::string& type_and_data) {
  uint32_t crc = 0xffffffffu;  // [ISO 15948, annex D]
  for (const char c : type_and_data) {
    crc ^= uint8_t(c);
    for (int k = 0; k < 8; ++k) crc = (crc & 1) ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
  }
  return big_endian(uint32_t(type_and_data.size()) - 4) + type_and_data + big_endian(~crc);
}
/// Checksums right, 8 bits of RGBA, one row of nothing compressed.
std::string png_that_says(uint32_t width, uint32_t height) {
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR" + big_endian(width) + big_endian(height) +
                   std::string("\x8\x6\0\0\0", 5)) +
         png_chunk(std::string("IDAT\x78\x9c\x3\0\0\0\0\x1", 12)) + png_chunk("IEND");
}
std::string jpeg_that_says(uint32_t width, uint32_t height) {
  const std::string frame = std::string("\xff\xc0\0\x0b\x8", 5) + big_endian(height).substr(2) +
                            big_endian(width).substr(2) + std::string("\x1\x1\x11\0", 4);
  return "\xff\xd8" + frame + std::string("\xff\xda\0\x8\x1\x1\0\0\x3f\0\0\xff\xd9", 13);
}
/// The extended header of an animation, which alone may have a canvas larger than a picture.
std::string webp_that_says(uint32_t width, uint32_t height) {
  const auto little24 = [](uint32_t v) {
    return std::string{char(v & 255), char(v >> 8 & 255), char(v >> 16 & 255)};
  };
  const std::string body = "WEBPVP8X" + std::string("\xa\0\0\0\x2\0\0\0", 8) + little24(width - 1) +
                           little24(height - 1) +
                           std::string("VP8L\x8\0\0\0\x2f\0\0\0\0\0\0\0", 16);
  return "RIFF" + std::string{char(body.size()), 0, 0, 0} + body;
}

// 100,000 x 100,000 pixels would take 40 GB: the header is enough to refuse them.
TEST(PicturesTooLarge, AreRefusedByTheirHeader) {
  EXPECT_THAT(decoded_webp(png_that_says(100000, 100000)).error().message,
              HasSubstr("pic: the picture has 100000 x 100000 pixels, must be 1 to 16384 a side"));
  EXPECT_THAT(decoded_webp(png_that_says(4, 16385)).error().message, HasSubstr("4 x 16385 pixels"));
  EXPECT_THAT(decoded_webp(jpeg_that_says(65500, 40000)).error().message,
              HasSubstr("pic: the picture has 65500 x 40000 pixels, must be 1 to 16384"));
  EXPECT_THAT(decoded_webp(jpeg_that_says(65535, 40000)).error().message,
              HasSubstr("Maximum supported image dimension is 65500 pixels"));
  EXPECT_THAT(decoded_webp(webp_that_says(60000, 60000)).error().message,
              HasSubstr("pic: the picture has 60000 x 60000 pixels, must be 1 to 16384"));
}

TEST(PicturesTooLarge, PicturesOfNothingAreRefused) {
  for (const auto& [width, height] : {std::pair{0u, 4u}, {4u, 0u}, {0u, 0u}}) {
    EXPECT_THAT(decoded_webp(png_that_says(width, height)).error().message,
                HasSubstr("pixels, must be"));
    EXPECT_THAT(decoded_webp(jpeg_that_says(width, height)).error().message,
                HasSubstr("Empty JPEG image"));
  }
}

}  // namespace
}  // namespace luxel::image
