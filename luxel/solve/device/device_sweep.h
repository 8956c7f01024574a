// A sweep of gather on a graphics device: what each element's rays bring from the map.
#pragma once

#include "luxel/solve/device/landed_rays.h"
#include "luxel/solve/device/sweep_shared.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"

namespace luxel::device {

/// Gathers light from the map by the rounds that count. `out` gets one value per element, equal to
/// the sum of gather::gather_round() but for the order of terms. Returns the seconds until the
/// device was done. Errors: no memory, the device is lost.
Result<double> sweep(gpu::Commands& commands, LandedRays& rays, const gather::RadiosityMap& map,
                     std::span<on_device::Gathered> out);

}  // namespace luxel::device
