// Light that a lightmap picture holds.
#pragma once

#include "luxel/image/image.h"
#include "luxel/scene/scene.h"

namespace luxel::display {

/// Bilinear lookup of a lightmap at a point of a scene whose TEXCOORD_1 are its places. The gutter
/// is expected to be dilated, so that no weight needs to be renormalised. Zero where a mesh has no
/// TEXCOORD_1.
Rgb lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                const scene::SurfacePoint& p);

}  // namespace luxel::display
