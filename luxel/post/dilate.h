// Fills the gutter between charts so that bilinear lookups and mipmaps do not see black.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/image/image.h"

namespace luxel::post {

/// Lightmap of 4 channels: R G B = values of the texels of `map`, A = 1 where a triangle holds the
/// texel's centre, 0.5 where the texel was sampled off its centre, 0 elsewhere.
image::Image lightmap_from_texels(const atlas::TexelMap& map, std::span<const Rgb> values);

/// Lightmaps per page of the atlas (atlas::pages_of): a lightmap as large as each.
std::vector<image::Image> lightmap_pages(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                         std::span<const Rgb> values);

/// Extends the covered texels (A > 0) outwards `rings` times: each empty texel takes the mean of
/// its covered 8-neighbours (of earlier rings) and A = 0.5. Covered texels never change. rings < 0
/// fills the whole image.
void dilate(image::Image& lightmap, int rings);
/// Rings of a bake's lightmaps: enough for bilinear look-ups in four mipmap levels.
inline constexpr int kDilationRings = 8;

}  // namespace luxel::post
