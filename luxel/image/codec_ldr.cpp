#include "luxel/image/codec_ldr.h"

#include "luxel/base/parallel.h"
#include "luxel/image/color.h"

namespace luxel::image {
namespace {

/// Rounds to nearest. Written so that NaN becomes 0: a cast of NaN is undefined.
uint8_t byte_from_unit(float v) {
  if (!(v > 0)) return 0;
  return v >= 1 ? uint8_t(255) : uint8_t(v * 255.0f + 0.5f);
}

}  // namespace

Status check_picture_size(uint32_t width, uint32_t height, std::string_view name) {
  constexpr uint32_t kMaxSide = 16384;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    return fail(ErrorCode::bad_input, "{}: the picture has {} x {} pixels, must be 1 to {} a side",
                name, width, height, kMaxSide);
  return {};
}

Result<Image8> decode_ldr(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow) {
  if (bytes.empty()) return fail(ErrorCode::bad_input, "{}: the picture is empty", name);
  if (is_webp(bytes)) return decode_webp(bytes, name, allow);
  if (is_jpeg(bytes)) return decode_jpeg(bytes, name, allow);
  if (is_png(bytes)) return decode_png(bytes, name, allow);
  if (is_bmp(bytes)) return decode_bmp(bytes, name, allow);
  if (is_tga(bytes)) return decode_tga(bytes, name, allow);
  return fail(ErrorCode::unsupported,
              "{}: the picture is none of PNG, JPEG, WebP, BMP and TGA; convert it to one of them",
              name);
}

Result<Image> decode_display(std::span<const std::byte> bytes, std::string_view name) {
  if (is_png(bytes)) return decode_png_values(bytes, name);
  LUXEL_TRY(const Image8 pixels, decode_ldr(bytes, name));
  Image image(pixels.width, pixels.height, 4);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = float(pixels.data[i]) / 255.0f;
  return image;
}

Image8 to_srgb8(const Image& linear) {
  Image8 out{linear.width, linear.height, linear.channels, {}};
  out.data.resize(linear.data.size());
  const size_t channels = size_t(linear.channels);
  parallel_for(size_t(linear.height), 16, [&](size_t row_begin, size_t row_end) {
    const size_t stride = size_t(linear.width) * channels;
    for (size_t i = row_begin * stride; i < row_end * stride; ++i) {
      const float v = linear.data[i];
      const bool is_alpha = i % channels == 3;
      out.data[i] = byte_from_unit(is_alpha ? v : srgb_from_linear(std::max(v, 0.0f)));
    }
  });
  return out;
}

}  // namespace luxel::image
