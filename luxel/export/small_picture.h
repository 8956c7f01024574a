// Maps of the surroundings small enough to be carried along.
#pragma once

#include "luxel/image/image.h"
#include "luxel/scene/environment.h"

namespace luxel::export_ {

/// The map's radiance, 4 channels, alpha 1, at most `width` pixels wide and half as many high: each
/// pixel is the mean over the part of the map's rectangle that it covers.
image::Image small_picture(const scene::Environment& map, int width);

}  // namespace luxel::export_
