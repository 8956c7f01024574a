// The irradiance that white stands for where light is stored with few bits per channel.
#pragma once

#include <span>

#include "luxel/base/vec.h"
#include "luxel/image/image.h"

namespace luxel::image {

/// The 99.9th percentile of the largest channel, so that a few texels beside a light do not take
/// all the steps from the rest; those clip. Where the percentile is dark, the largest value; where
/// all is dark, 1. In the unit of the values, and above zero.
float white_level(std::span<const Rgb> values);
/// One white level of several images, such as the pages of a lightmap, over the pixels whose fourth
/// channel, the coverage, is above zero. The images have four channels.
float white_level(std::span<const Image> images);

}  // namespace luxel::image
