// Lightmap coordinates that the file brings along.
#pragma once

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {

/// The atlas that TEXCOORD_1 describes. Errors name the mesh and the triangles: no TEXCOORD_1,
/// coordinates outside [0, 1], a texel centre inside two triangles.
Result<Atlas> keep_uv1(const scene::Scene& scene, int resolution, const Progress& progress);

}  // namespace luxel::atlas
