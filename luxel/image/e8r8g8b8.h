// E8R8G8B8: high dynamic range in the 32 bits of a pixel. [Rodriguez06, section 5.7]
//
// Three bytes of colour share the exponent in the fourth: c = byte / 255 * 2^(e - 128). A kin of
// Radiance's RGBE, with other constants: it cannot be stored as .hdr without loss.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/image/image.h"

namespace luxel::image {

/// A colour whose three 8-bit components share an 8-bit exponent. [Rodriguez06, section 5.7]
struct E8R8G8B8 {
  uint8_t e = 0, r = 0, g = 0, b = 0;
  friend bool operator==(const E8R8G8B8&, const E8R8G8B8&) = default;
};

/// The largest colour that can be said, 2^127.
inline constexpr float kMostE8R8G8B8 = 0x1p127f;

/// The nearest code. For colours whose largest component lies in [2^-128, 2^127], from_e8r8g8b8
/// gives every component back within 1/256 of the largest one. Below, steps are 2^-128 / 255 and
/// the smallest colours become 0. What has no place is put somewhere, per component: negative
/// values and NaN are 0, values above 2^127 and infinity are 2^127. Black is four zero bytes.
E8R8G8B8 to_e8r8g8b8(Rgb color);
/// Every code means a finite colour.
Rgb from_e8r8g8b8(E8R8G8B8 code);

/// As Direct3D lays out A8R8G8B8, the exponent in the place of alpha: e << 24 | r << 16 | g << 8 |
/// b.
uint32_t pack(E8R8G8B8 code);
/// The inverse of pack().
E8R8G8B8 unpack_e8r8g8b8(uint32_t bits);

/// The first three channels of an image, row by row, and back to three channels.
std::vector<uint32_t> encode_e8r8g8b8(const Image& image);
/// The inverse of encode_e8r8g8b8(): three channels; `codes` has width * height entries.
Image decode_e8r8g8b8(const std::vector<uint32_t>& codes, int width, int height);

}  // namespace luxel::image
