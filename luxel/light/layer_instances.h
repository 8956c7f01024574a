// The surfaces that belong to a layer of light.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/light/light_layers.h"

namespace luxel::light {

/// Per layer, the instances all of whose own light is in it, in their order: those that look dark
/// when the layer is turned down. An instance whose materials shine in several layers is in none.
std::vector<std::vector<uint32_t>> instances_of_layers(const Lights& lights,
                                                       const LightLayers& layers);

}  // namespace luxel::light
