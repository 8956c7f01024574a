// Width of a texel in the world.
#pragma once

#include "luxel/atlas/atlas.h"

namespace luxel::transport {

/// On a triangle of an instance: the side of a square as large as a texel there [m]. 0 where the
/// triangle has no area in the atlas.
float texel_width_m(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t instance,
                    uint32_t triangle);
/// Where the triangle's corners are known already; `number` is its number in the atlas.
float texel_width_m(const atlas::Atlas& atlas, uint32_t number, const scene::Triangle3& world);

}  // namespace luxel::transport
