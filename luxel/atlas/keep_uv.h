// Lightmap coordinates that the file brings along.
#pragma once

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {

/// The atlas that TEXCOORD_1 describes. Errors name the mesh and the triangles: no TEXCOORD_1,
/// coordinates outside [0, 1], a mesh in two places, a texel centre inside two triangles.
Result<Atlas> keep_uv1(const scene::Scene& scene, int resolution, const Progress& progress);

/// The reason why that atlas cannot hold the light, though it can be drawn: more than a hundredth
/// of an instance's area has none there (an object that was never unwrapped), or of the scene's
/// lies in texels of what is far away. Empty: it can. Errors: cancelled.
Result<std::string> why_no_layout(const scene::Scene& scene, const Atlas& kept,
                                  const Progress& progress);

}  // namespace luxel::atlas
