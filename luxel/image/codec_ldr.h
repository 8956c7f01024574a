// Pictures of 8 bits, format by format, for codec_ldr.cpp. Each to RGBA; errors: damaged, too
// large, not allowed.
#pragma once

#include <optional>

#include "luxel/image/codec.h"

namespace luxel::image {

bool is_jpeg(std::span<const std::byte> bytes);
/// Four inks (CMYK) become the light that they leave. Also refused: more than 100 scans.
Result<Image8> decode_jpeg(std::span<const std::byte> bytes, std::string_view name,
                           const AllowSize& allow);

bool is_png(std::span<const std::byte> bytes);
Result<Image8> decode_png(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow);
/// Four channels in [0, 1], with all 16 bits that there may be.
Result<Image> decode_png_values(std::span<const std::byte> bytes, std::string_view name);

bool is_webp(std::span<const std::byte> bytes);
/// Also refused: animations.
Result<Image8> decode_webp(std::span<const std::byte> bytes, std::string_view name,
                           const AllowSize& allow);

bool is_bmp(std::span<const std::byte> bytes);
/// Also refused (unsupported): packed by runs.
Result<Image8> decode_bmp(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow);

/// TGA has no mark of its own: ask for the others first.
bool is_tga(std::span<const std::byte> bytes);
Result<Image8> decode_tga(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow);

/// The pixels of a file as stb finds them, which has passed every check that stb does not make
/// itself. None: stbi_failure_reason() says why.
std::optional<Image8> load_with_stb(std::span<const uint8_t> bytes);

/// An error for a side of no pixels or of too many: a header that lies would cost gigabytes.
Status check_picture_size(uint32_t width, uint32_t height, std::string_view name);

}  // namespace luxel::image
