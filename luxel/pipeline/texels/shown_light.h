// The lightmap for viewers that know nothing of scattered light.
#pragma once

#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Viewers multiply a lightmap by the base colour and (1 - metallic). Per texel, the irradiance
/// that makes this product the light which the surface sends: E where nothing is scattered through,
/// else (rho E + tau E behind) / (base colour (1 - metallic)), of which a hundredth is the least
/// that is divided by. `irradiance`: E per texel of the map.
std::vector<Rgb> shown_irradiance(const scene::Scene& scene, const atlas::Atlas& atlas,
                                  const atlas::TexelMap& map, std::span<const Rgb> irradiance);

}  // namespace luxel::pipeline
