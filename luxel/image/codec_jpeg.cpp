#include "luxel/image/codec_ldr.h"

#include <cstddef>
#include <cstdio>
// jpeglib.h needs both of them before it.
#include <jerror.h>
#include <jpeglib.h>

#include <array>
#include <csetjmp>
#include <string>

namespace luxel::image {
namespace {

/// libjpeg reports errors by a call that must not return. stop() leaves what was called here by
/// longjmp(), which runs no destructor: between setjmp() and the library's calls no object may have
/// one.
struct JpegReader {
  jpeg_decompress_struct library{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf failed;
  std::string message;

  JpegReader() = default;
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&library); }
};

[[noreturn]] void stop(JpegReader& reader, const char* message) {
  reader.message = message;
  std::longjmp(reader.failed, 1);
}

JpegReader& reader_of(j_common_ptr library) {
  return *static_cast<JpegReader*>(library->client_data);
}

[[noreturn]] void on_error(j_common_ptr library) {
  std::array<char, JMSG_LENGTH_MAX> message{};
  library->err->format_message(library, message.data());
  stop(reader_of(library), message.data());
}

/// Level -1 is a warning, 0 and more are news. After most warnings the library goes on with pixels
/// that it made up; the ones named here cost none.
void on_message(j_common_ptr library, int level) {
  if (level >= 0) return;
  switch (library->err->msg_code) {
    case JWRN_ADOBE_XFORM:
    case JWRN_EXTRANEOUS_DATA:
    case JWRN_JFIF_MAJOR:
    case JWRN_NOT_SEQUENTIAL:
      return;
    default:
      on_error(library);
  }
}

/// A scan of a progressive picture may be two bytes long and takes as much time as a whole one; ten
/// or so are usual.
void on_progress(j_common_ptr library) {
  constexpr int kMostScans = 100;
  if (reinterpret_cast<j_decompress_ptr>(library)->input_scan_number > kMostScans)
    stop(reader_of(library), "It has more than 100 scans");
}

/// Sets what the library calls back, then reads up to the first scan. False: see reader.message.
bool read_header(JpegReader& reader, std::span<const std::byte> bytes) {
  reader.library.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = on_error;
  reader.errors.emit_message = on_message;
  reader.library.client_data = &reader;
  if (setjmp(reader.failed)) return false;
  jpeg_create_decompress(&reader.library);
  reader.progress.progress_monitor = on_progress;
  reader.library.progress = &reader.progress;
  jpeg_mem_src(&reader.library, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&reader.library, TRUE);
  const bool is_of_inks = reader.library.num_components == 4;
  reader.library.out_color_space = is_of_inks ? JCS_CMYK : JCS_RGB;
  return true;
}

/// Appends a row of red, green, blue (and ink, where `channels` is 4) to RGBA pixels.
/// `is_inverted`: Adobe writes four inks as the light that each of them leaves.
void append_row(std::span<const uint8_t> row, size_t channels, bool is_inverted,
                std::vector<uint8_t>& rgba) {
  for (size_t i = 0; i + channels <= row.size(); i += channels) {
    const uint8_t* from = row.data() + i;
    const auto left = [&](size_t c) { return is_inverted ? from[c] : 255 - from[c]; };
    for (size_t c = 0; c < 3; ++c)
      rgba.push_back(channels == 3 ? from[c] : uint8_t((left(c) * left(3) + 127) / 255));
    rgba.push_back(255);
  }
}

/// Appends all rows to `rgba`, which has the memory for them already; `row` is one of them. False:
/// see reader.message.
bool read_rows(JpegReader& reader, std::span<uint8_t> row, std::vector<uint8_t>& rgba) {
  jpeg_decompress_struct& library = reader.library;
  if (setjmp(reader.failed)) return false;
  jpeg_start_decompress(&library);
  while (library.output_scanline < library.output_height) {
    JSAMPROW to = row.data();
    jpeg_read_scanlines(&library, &to, 1);
    append_row(row, size_t(library.output_components), library.saw_Adobe_marker, rgba);
  }
  jpeg_finish_decompress(&library);
  return true;
}

}  // namespace

bool is_jpeg(std::span<const std::byte> bytes) {
  return bytes.size() >= 3 && bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xd8} &&
         bytes[2] == std::byte{0xff};
}

Result<Image8> decode_jpeg(std::span<const std::byte> bytes, std::string_view name,
                           const AllowSize& allow) {
  JpegReader reader;
  const auto damage = [&] {
    return fail(ErrorCode::bad_input, "{}: cannot decode the JPEG picture: {}", name,
                reader.message);
  };
  if (!read_header(reader, bytes)) return damage();
  const uint32_t width = reader.library.image_width, height = reader.library.image_height;
  LUXEL_TRY_STATUS(check_picture_size(width, height, name));
  // Besides the pixels: what many scans add up to is kept in up to twice their bytes.
  const int times = jpeg_has_multiple_scans(&reader.library) ? 3 : 1;
  for (int i = 0; allow && i < times; ++i) LUXEL_TRY_STATUS(allow(width, height));
  const size_t channels = reader.library.out_color_space == JCS_CMYK ? 4 : 3;
  std::vector<uint8_t> row(channels * width);
  Image8 image{int(width), int(height), 4, {}};
  image.data.reserve(size_t(4) * width * height);
  if (!read_rows(reader, row, image.data)) return damage();
  return image;
}

}  // namespace luxel::image
