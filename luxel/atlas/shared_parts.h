// Texels that belong to more than one chart: only a kept TEXCOORD_1 has any.
#pragma once

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {

/// The part of a texel that one triangle covers which is not of the texel's own chart: it gets that
/// chart's light.
struct SharedPart {
  uint32_t texel = 0;          ///< index into map.texels
  scene::SurfacePoint middle;  ///< the part's centroid
  float area = 0;              ///< of the texel's square
};
/// All such parts of overlapping_texels(), in the order of the triangles.
std::vector<SharedPart> shared_parts(const Atlas& atlas, const TexelMap& map);

}  // namespace luxel::atlas
