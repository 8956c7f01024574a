// Normals bent by normal maps. Global illumination does not look at them; pictures do.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// The shading normal at a point, bent by its material's normal map as glTF 2.0 defines it: red
/// along the texture's u, green against its v, blue along the normal, red and green times
/// normal_scale. The tangent is that of the triangle's texture coordinates, also in files that
/// bring their own. World space, unit. Without a map, or coordinates for it, the shading normal.
Vec3 bent_normal(const Scene& scene, const SurfacePoint& p);

}  // namespace luxel::scene
