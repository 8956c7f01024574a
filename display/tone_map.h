// From radiance to what a screen can show.
#pragma once

#include "image/codec.h"
#include "image/image.h"

namespace luxel::display {

/// The factor that brings the 90th percentile of luminance over pixels with A > 0 (all pixels when
/// there is no alpha) to 0.6; 1 for a black picture.
float auto_exposure(const image::Image& radiance);

/// Exposed linear radiance to 8-bit sRGB: linear up to about 0.5, then a smooth shoulder that never
/// clips, applied to luminance so that hues stay, bright colours moving to white.
image::Image8 tone_map(const image::Image& radiance, float exposure);

}  // namespace luxel::display
