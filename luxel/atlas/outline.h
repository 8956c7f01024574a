// Smoother outlines for charts of bent surfaces.
#pragma once

#include <vector>

#include "luxel/atlas/faces.h"

namespace luxel::atlas {

/// Merging leaves teeth along the outlines, which pack badly and cost gutter. Moves faces over to
/// the neighbouring chart that holds most of the faces around them, where that chart's angle allows
/// it. Flat patches stay whole. `chart` is per face; charts may lose their last face.
void smooth_outlines(const Faces& faces, const std::vector<uint32_t>& patch, double max_angle,
                     std::vector<uint32_t>& chart);

}  // namespace luxel::atlas
