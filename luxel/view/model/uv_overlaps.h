// Places of a lightmap that several surfaces share: each darkens or brightens the others.
#pragma once

#include <span>
#include <vector>

#include "luxel/image/codec.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/scene/scene.h"

namespace luxel::view {

/// For each page a picture of one channel with two by two pixels for each texel of the lightmap:
/// 255 where two triangles or more cover the pixel's middle, or one mesh that is placed twice; else
/// 0. `light_uv` is of each mesh and vertex; empty: uv1 is. Materials without light of their own
/// are left out.
std::vector<image::Image8> uv_overlaps(const scene::Scene& scene,
                                       const pipeline::LightmapPages& lightmaps,
                                       std::span<const std::vector<Vec2>> light_uv);

}  // namespace luxel::view
