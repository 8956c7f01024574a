// RGBE: high dynamic range in 32 bits, three mantissas that share an exponent. [Ward91]
#pragma once

#include <array>
#include <cstdint>

#include "luxel/image/codec.h"
#include "luxel/image/image.h"

namespace luxel::image {

/// Red, green, blue, exponent.
using Rgbe = std::array<uint8_t, 4>;

/// The nearest code: every component comes back within 1/256 of the largest one. Negative values
/// become 0, colours whose largest component is below 1e-38 black (four zero bytes), components
/// above 255 * 2^119 that.
Rgbe to_rgbe(Rgb color);
/// c = byte * 2^(e - 136); e = 0 is black whatever the bytes.
std::array<double, 3> from_rgbe(Rgbe code);

/// The first three channels as an RGBA picture whose alpha is the exponent: with texel values in
/// [0, 1], c = 255 rgb 2^(255 a - 136). The pixels are those of encode_hdr.
Image8 rgbe_picture(const Image& image);

}  // namespace luxel::image
