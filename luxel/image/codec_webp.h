// WebP, for codec_ldr.cpp.
#pragma once

#include "luxel/image/codec.h"

namespace luxel::image {

bool is_webp(std::span<const std::byte> bytes);
/// To RGBA. Errors: damaged, animated, too large, not allowed.
Result<Image8> decode_webp(std::span<const std::byte> bytes, std::string_view name,
                           const AllowSize& allow);

/// An error for a side of no pixels or of too many: a header that lies would cost gigabytes.
Status check_picture_size(uint32_t width, uint32_t height, std::string_view name);

}  // namespace luxel::image
