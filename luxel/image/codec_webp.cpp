#include "luxel/image/codec_ldr.h"

#include <webp/decode.h>

#include <cstring>

namespace luxel::image {

bool is_webp(std::span<const std::byte> bytes) {
  return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

Result<Image8> decode_webp(std::span<const std::byte> bytes, std::string_view name,
                           const AllowSize& allow) {
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  WebPBitstreamFeatures header{};
  if (WebPGetFeatures(data, bytes.size(), &header) != VP8_STATUS_OK)
    return fail(ErrorCode::bad_input, "{}: the WebP picture is damaged: its header ends early",
                name);
  LUXEL_TRY_STATUS(check_picture_size(uint32_t(header.width), uint32_t(header.height), name));
  if (header.has_animation)
    return fail(ErrorCode::unsupported, "{}: the WebP picture is animated; export a still one",
                name);
  if (allow) LUXEL_TRY_STATUS(allow(uint32_t(header.width), uint32_t(header.height)));
  Image8 image{header.width, header.height, 4, {}};
  const size_t row = size_t(4) * size_t(header.width);
  image.data.resize(row * size_t(header.height));
  if (WebPDecodeRGBAInto(data, bytes.size(), image.data.data(), image.data.size(), int(row)) ==
      nullptr)
    return fail(ErrorCode::bad_input, "{}: the WebP picture is damaged or ends early", name);
  return image;
}

}  // namespace luxel::image
