#include "luxel/image/codec_webp.h"

#include <webp/decode.h>

#include <cstring>

namespace luxel::image {

bool is_webp(std::span<const std::byte> bytes) {
  return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

namespace {

Result<WebPBitstreamFeatures> header_of(std::span<const std::byte> bytes, std::string_view name) {
  WebPBitstreamFeatures header{};
  if (WebPGetFeatures(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), &header) !=
      VP8_STATUS_OK)
    return fail(ErrorCode::bad_input, "{}: the WebP picture is damaged: its header ends early",
                name);
  LUXEL_TRY_STATUS(check_picture_size(uint32_t(header.width), uint32_t(header.height), name));
  if (header.has_animation)
    return fail(ErrorCode::unsupported, "{}: the WebP picture is animated; export a still one",
                name);
  return header;
}

}  // namespace

Result<std::array<uint32_t, 2>> size_of_webp(std::span<const std::byte> bytes,
                                             std::string_view name) {
  LUXEL_TRY(const WebPBitstreamFeatures header, header_of(bytes, name));
  return std::array<uint32_t, 2>{uint32_t(header.width), uint32_t(header.height)};
}

Result<Image8> decode_webp(std::span<const std::byte> bytes, std::string_view name) {
  LUXEL_TRY(const WebPBitstreamFeatures header, header_of(bytes, name));
  Image8 image{header.width, header.height, 4, {}};
  const size_t row = size_t(4) * size_t(header.width);
  image.data.resize(row * size_t(header.height));
  if (WebPDecodeRGBAInto(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(),
                         image.data.data(), image.data.size(), int(row)) == nullptr)
    return fail(ErrorCode::bad_input, "{}: the WebP picture is damaged or ends early", name);
  return image;
}

}  // namespace luxel::image
