// PNG out, and the step from linear light to 8 bits.
#include <stb/stb_image_write.h>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/image/codec.h"
#include "luxel/image/color.h"

namespace luxel::image {
namespace {

/// Rounds to nearest. Written so that NaN becomes 0: a cast of NaN is undefined.
uint8_t byte_from_unit(float v) {
  if (!(v > 0)) return 0;
  return v >= 1 ? uint8_t(255) : uint8_t(v * 255.0f + 0.5f);
}

void append(void* context, void* data, int size) {
  auto& out = *static_cast<std::vector<std::byte>*>(context);
  const std::byte* bytes = static_cast<const std::byte*>(data);
  out.insert(out.end(), bytes, bytes + size);
}

}  // namespace

std::vector<std::byte> encode_png(const Image8& image) {
  LUXEL_CHECK(image.width > 0 && image.height > 0);
  LUXEL_CHECK(image.channels >= 1 && image.channels <= 4);
  LUXEL_CHECK(image.data.size() ==
              size_t(image.width) * size_t(image.height) * size_t(image.channels));
  // stb's global knobs (flip, filter, compression level) are left at their defaults on purpose:
  // they belong to the process, and other threads may be encoding.
  std::vector<std::byte> out;
  const int ok = stbi_write_png_to_func(append, &out, image.width, image.height, image.channels,
                                        image.data.data(), image.width * image.channels);
  LUXEL_CHECK(ok != 0);  // fails only for sizes beyond the checks above, or without memory
  return out;
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
