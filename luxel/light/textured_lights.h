// Emissive triangles cut where their texture's brightness varies.
#pragma once

#include <vector>

#include "luxel/light/lights.h"

namespace luxel::light {

/// Cuts a textured light by halving its sides, again and again where brightness varies most, until
/// the pieces hardly vary or there are `max_pieces`. Each has the mean radiance of its own part;
/// one that looks dark has a thousandth of the triangle's, because what shines may lie between the
/// places that were looked at. Together they are the triangle.
std::vector<TriangleLight> pieces_by_brightness(const scene::Scene& scene,
                                                const TriangleLight& light, size_t max_pieces);

}  // namespace luxel::light
