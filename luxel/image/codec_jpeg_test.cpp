// Pictures written by libjpeg's encoder and by stb's, then damaged.
#include <gmock/gmock.h>
#include <stb/stb_image_write.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
// jpeglib.h needs both of them before it.
#include <jpeglib.h>

#include <string>

#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

using ::testing::HasSubstr;

Result<Image8> decoded_jpeg(const std::string& file) {
  return decode_ldr(std::as_bytes(std::span(file.data(), file.size())), "pic");
}

enum class Scans { one, ten, one_per_coefficient };

/// All pixels of one colour: grey, RGB (written as YCbCr) or four inks as Adobe writes them,
/// inverted.
std::string jpeg_of(int width, int height, const std::vector<uint8_t>& color,
                    Scans scans = Scans::one) {
  jpeg_compress_struct library{};
  jpeg_error_mgr errors{};
  library.err = jpeg_std_error(&errors);
  jpeg_create_compress(&library);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&library, &bytes, &size);
  library.image_width = JDIMENSION(width), library.image_height = JDIMENSION(height);
  library.input_components = int(color.size());
  library.in_color_space = color.size() == 1   ? JCS_GRAYSCALE
                           : color.size() == 3 ? JCS_RGB
                                               : JCS_CMYK;
  jpeg_set_defaults(&library);
  jpeg_set_quality(&library, 100, TRUE);
  if (scans == Scans::ten) jpeg_simple_progression(&library);
  std::vector<jpeg_scan_info> script{{3, {0, 1, 2}, 0, 0, 0, 0}};
  for (int component = 0; component < 3; ++component)
    for (int i = 1; i < 64; ++i) script.push_back({1, {component}, i, i, 0, 0});
  if (scans == Scans::one_per_coefficient)
    library.scan_info = script.data(), library.num_scans = int(script.size());
  jpeg_start_compress(&library, TRUE);
  std::vector<uint8_t> row;
  for (int x = 0; x < width; ++x) row.insert(row.end(), color.begin(), color.end());
  JSAMPROW from = row.data();
  while (library.next_scanline < library.image_height) jpeg_write_scanlines(&library, &from, 1);
  jpeg_finish_compress(&library);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  jpeg_destroy_compress(&library);
  std::free(bytes);
  return file;
}

std::string jpeg_of_stb() {
  const std::vector<uint8_t> gray(16 * 16 * 3, 100);
  std::string file;
  const auto append = [](void* text, void* data, int size) {
    static_cast<std::string*>(text)->append(static_cast<const char*>(data), size_t(size));
  };
  stbi_write_jpg_to_func(append, &file, 16, 16, 3, gray.data(), 95);
  return file;
}

void expect_color(const std::string& file, int width, int height, const std::array<int, 3>& color) {
  const auto image = decoded_jpeg(file);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, width);
  EXPECT_EQ(image->height, height);
  ASSERT_EQ(image->data.size(), size_t(width) * size_t(height) * 4);
  for (size_t i = 0; i < image->data.size(); i += 4) {
    // Two steps: YCbCr is rounded once, and the coefficients' quantization once.
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(image->data[i + c], color[c], 2) << i;
    ASSERT_EQ(image->data[i + 3], 255);
  }
}

TEST(DecodeJpeg, ColorsComeBack) {
  expect_color(jpeg_of(19, 5, {200}), 19, 5, {200, 200, 200});
  expect_color(jpeg_of(19, 5, {200, 30, 90}), 19, 5, {200, 30, 90});
  expect_color(jpeg_of(19, 5, {200, 30, 90}, Scans::ten), 19, 5, {200, 30, 90});
  expect_color(jpeg_of_stb(), 16, 16, {100, 100, 100});
}

// Each ink leaves so much light, and black so much of it: (200, 30, 90) x 128 / 255.
TEST(DecodeJpeg, InksBecomeTheLightThatTheyLeave) {
  std::string file = jpeg_of(8, 8, {200, 30, 90, 128});
  expect_color(file, 8, 8, {100, 15, 45});
  // Without Adobe's marker the numbers are the inks themselves: (55, 225, 165) x 127 / 255.
  const size_t marker = file.find("\xff\xee");
  ASSERT_NE(marker, file.npos);
  file.erase(marker, 16);
  expect_color(file, 8, 8, {27, 112, 82});
}

TEST(DecodeJpeg, EveryTruncationIsRefused) {
  for (const std::string& file :
       {jpeg_of_stb(), jpeg_of(19, 5, {200, 30, 90}), jpeg_of(19, 5, {200, 30, 90}, Scans::ten)})
    for (size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(decoded_jpeg(file.substr(0, length))) << length << " of " << file.size();
}

// The pixels may change; what counts is that there is a result.
TEST(DecodeJpeg, FlippedBitsGiveAResult) {
  for (const std::string& good : {jpeg_of_stb(), jpeg_of(19, 5, {200, 30, 90}, Scans::ten)})
    for (size_t i = 0; i < good.size(); ++i) {
      std::string bad = good;
      bad[i] = char(bad[i] ^ 4);
      (void)decoded_jpeg(bad);
    }
}

// Cameras leave bytes behind the codes of the last row; no pixel depends on them.
TEST(DecodeJpeg, BytesThatNoPixelNeedsAreSkipped) {
  std::string file = jpeg_of(19, 5, {200, 30, 90});
  file.insert(file.size() - 2, "camera");
  expect_color(file, 19, 5, {200, 30, 90});
}

TEST(DecodeJpeg, PixelsThatTheLibraryWouldMakeUpAreRefused) {
  // Two rows of blocks, of which the codes of the second are missing.
  std::string file = jpeg_of(512, 16, {200, 30, 90});
  file.erase(file.size() - 12, 10);
  const auto image = decoded_jpeg(file);
  ASSERT_FALSE(image);
  EXPECT_EQ(
      image.error().message,
      "pic: cannot decode the JPEG picture: Corrupt JPEG data: premature end of data segment");
}

TEST(DecodeJpeg, AsksForAllTheMemoryThatItTakes) {
  const auto asked_for = [](Scans scans) {
    const std::string file = jpeg_of(30, 20, {200, 30, 90}, scans);
    uint64_t pixels = 0;
    EXPECT_TRUE(decode_ldr(std::as_bytes(std::span(file.data(), file.size())), "pic",
                           [&](uint32_t width, uint32_t height) -> Status {
                             pixels += uint64_t(width) * height;
                             return {};
                           }));
    return pixels;
  };
  EXPECT_EQ(asked_for(Scans::one), 600u);
  EXPECT_EQ(asked_for(Scans::ten), 1800u);
}

// A scan of a few bytes takes as long as any other. [libjpeg-turbo, LJT-01-003]
TEST(DecodeJpeg, HundredsOfScansAreRefused) {
  const auto image = decoded_jpeg(jpeg_of(16, 16, {200, 30, 90}, Scans::one_per_coefficient));
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().message,
            "pic: cannot decode the JPEG picture: It has more than 100 scans");
}

}  // namespace
}  // namespace luxel::image
