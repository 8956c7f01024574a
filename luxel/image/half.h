// Images as 16-bit floats, which graphics cards filter as they are.
#pragma once

#include <cstdint>
#include <span>
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

/// As above with a scale that is given; what lies beyond the largest half becomes that.
HalfImage to_half(const Image& image, float scale);
/// The scale of pictures that are files for others: 1 where the largest colour component of all is
/// from 1/8 to 65504, so that nobody needs it; else the power of two that brings it into
/// [2^14, 2^15).
float scale_for_files(std::span<const Image> images);

/// The number that the bits of a half are.
float from_half(uint16_t bits);

}  // namespace luxel::image
