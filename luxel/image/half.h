// Images as 16-bit floats, which graphics cards filter as they are.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/image/image.h"

namespace luxel::image {

/// An image in IEEE binary16: value = scale * half.
struct HalfImage {
  int width = 0, height = 0, channels = 0;
  float scale = 1;  ///< of the first three channels, a power of two; alpha has none
  std::vector<uint16_t> data;
};

/// Rounds to nearest, ties to even. The scale brings the largest colour component into
/// [2^14, 2^15), below the largest half, 65504: colours down to 2^-28 of the largest keep 11 bits,
/// an error of at most 2^-11 of the value; below, errors are at most 2^-25 scale. Values are finite
/// and a black image has scale 1.
HalfImage to_half(const Image& image);

/// The number that the bits of a half are.
float from_half(uint16_t bits);

}  // namespace luxel::image
