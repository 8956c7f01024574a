// Pictures written by stb's encoders, then damaged.
#include <gmock/gmock.h>
#include <stb/stb_image_write.h>

#include <cstring>
#include <string>

#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

using ::testing::HasSubstr;

void append(void* text, void* data, int size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(data), size_t(size));
}
const std::vector<uint8_t> kPixels{255, 0, 0, 255, 0, 128, 7, 64, 1, 2, 3, 4};  // 3 x 1 RGBA
std::string png() {
  std::string file;
  stbi_write_png_to_func(append, &file, 3, 1, 4, kPixels.data(), 12);
  return file;
}
Result<Image8> decoded_ldr(const std::string& file) {
  return decode_ldr(std::as_bytes(std::span(file.data(), file.size())), "pic");
}

TEST(DecodeLdr, PngComesBackExactly) {
  const auto image = decoded_ldr(png());
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 1);
  EXPECT_EQ(image->data, kPixels);
}

TEST(DecodeDisplay, BytesAreOver255) {
  const std::string file = png();
  const auto image = decode_display(std::as_bytes(std::span(file.data(), file.size())), "pic");
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->data.size(), kPixels.size());
  for (size_t i = 0; i < kPixels.size(); ++i) EXPECT_EQ(image->data[i], float(kPixels[i]) / 255);
}

// A file of 2 x 1 grey pixels of 16 bits, 0x0102 and 0xfffe: the header, a stored (not compressed)
// block with the row's filter byte 0, and the end; checksums from Python's zlib.
TEST(DecodeDisplay, SixteenBitsAreKept) {
  const std::vector<uint8_t> file{
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
      0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x81,
      0xd9, 0xfc, 0x15, 0x00, 0x00, 0x00, 0x10, 0x49, 0x44, 0x41, 0x54, 0x78, 0x01, 0x01, 0x05,
      0x00, 0xfa, 0xff, 0x00, 0x01, 0x02, 0xff, 0xfe, 0x03, 0x0b, 0x02, 0x01, 0x06, 0x90, 0x21,
      0x19, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  const auto image = decode_display(std::as_bytes(std::span(file)), "pic");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 2);
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(image->data[c], 258.0f / 65535);
    EXPECT_EQ(image->data[4 + c], 65534.0f / 65535);
  }
  EXPECT_EQ(image->data[3], 1);
  for (size_t length = 0; length < file.size(); ++length)
    EXPECT_FALSE(decode_display(std::as_bytes(std::span(file).first(length)), "pic"));
}

TEST(DecodeLdr, EveryTruncationIsRefused) {
  const std::string file = png();
  for (size_t length = 0; length < file.size(); ++length)
    EXPECT_FALSE(decoded_ldr(file.substr(0, length))) << length << " of " << file.size();
}

// A PNG's chunks carry checksums: no flipped bit inside one goes unseen.
TEST(DecodeLdr, FlippedBitsAreSeen) {
  const std::string good = png();
  for (size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = char(bad[i] ^ 4);
    EXPECT_FALSE(decoded_ldr(bad)) << i;
  }
}

TEST(DecodeLdr, TooLargeOtherFormatsAndNothing) {
  EXPECT_THAT(decoded_ldr("GIF89a").error().message,
              HasSubstr("pic: the picture is none of PNG, JPEG, WebP, BMP and TGA"));
  EXPECT_THAT(decoded_ldr("").error().message, HasSubstr("empty"));
  const std::vector<uint8_t> row(16385);
  std::string wide;
  stbi_write_png_to_func(append, &wide, 16385, 1, 1, row.data(), 16385);
  EXPECT_THAT(decoded_ldr(wide).error().message, HasSubstr("16385 x 1"));
}

}  // namespace
}  // namespace luxel::image
