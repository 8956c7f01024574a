// The light of the sun under a clear sky, without the sky.
#pragma once

#include "luxel/scene/sky.h"

namespace luxel::scene {

/// Sky::sun_illuminance of make_sky(), bit by bit, within some milliseconds [lx].
Rgb sun_illuminance(const SkyParams& params);

}  // namespace luxel::scene
