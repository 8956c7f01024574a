// RGBM: high dynamic range in an 8-bit RGBA picture, a colour and the multiplier it shares.
// [Karis09]
#pragma once

#include <span>

#include "luxel/image/codec.h"
#include "luxel/image/image.h"

namespace luxel::image {

/// A picture and what its largest value stands for.
struct RgbmPicture {
  Image8 picture;   ///< 4 channels; rgb is not premultiplied by the multiplier in alpha
  float range = 1;  ///< > 0
};

/// With texel values in [0, 1], c = range a rgb. The range is the image's largest component, so
/// nothing is clipped (1 for a black image). Of a colour whose largest component is m every
/// component comes back within (m + range / 255) / 510; negative values become 0, black is four
/// zero bytes. The first three channels are taken.
RgbmPicture rgbm_picture(const Image& image);
/// A picture in a range that several share; what is larger is clipped.
Image8 rgbm_picture(const Image& image, float range);
/// The largest component of all images; 1 when they are black.
float rgbm_range(std::span<const Image> images);

}  // namespace luxel::image
