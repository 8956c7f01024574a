// From radiance to what a screen can show.
#pragma once

#include "image/codec.h"
#include "image/image.h"

namespace luxel::display {

/// The factor that brings the 90th percentile of luminance over pixels with A > 0 (all pixels when
/// there is no alpha) to 0.6; 1 for a black picture. Where more than 90 % of the pixels are black,
/// the black ones do not count.
float auto_exposure(const image::Image& radiance);

/// Exposed linear radiance in [0, 1): colours whose channels are all at most 0.5 stay as they are,
/// brighter ones go over a smooth shoulder that never clips, applied to luminance so that hues
/// stay, bright colours moving to white. Every channel grows with the exposure.
Rgb compress(Rgb exposed);

/// exposure * radiance, compressed, as 8-bit sRGB with 3 channels (alpha is dropped: the picture
/// stands for itself).
image::Image8 tone_map(const image::Image& radiance, float exposure);

}  // namespace luxel::display
