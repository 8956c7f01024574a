// Moves samples of texels out of solids.
#pragma once

#include <cstdint>
#include <vector>

#include "atlas/atlas.h"
#include "trace/ray_tracer.h"

namespace luxel::transport {

/// A texel across the foot of a wall has one sample, which may lie under the wall while half of the
/// texel lies in the room: it would be dark, or dropped. Samples that see the back of a surface
/// within a texel and a half, and nothing but backs altogether, move to the nearest place of their
/// texel, on a grid of 4 x 4 in their own triangle, that is in the open; without one they stay.
/// Returns the texels whose samples were moved.
std::vector<uint32_t> open_samples(const scene::Scene& scene, const atlas::Atlas& atlas,
                                   const trace::RayTracer& tracer, atlas::TexelMap& map);

}  // namespace luxel::transport
