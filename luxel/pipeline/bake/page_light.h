// The light that preview.png and view.html look up: the lightmap's, and some where it has none.
#pragma once

#include <vector>

#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// A hidden texel, and one in the open whose light it takes.
struct Lent {
  uint32_t texel = 0, from = 0;
};

/// Surfaces inside of solids are seen in slits, and by graphics cards as dotted lines: where two
/// surfaces meet, the rounding of their corners leaves some samples of pixels to neither. So hidden
/// texels that hold 0 take the light of the nearest open one in space, not farther away than one
/// and a half texels. Of several that are about as near the darkest counts: a dark dot in the light
/// is seen less than a light one in the dark.
std::vector<Lent> light_for_hidden(const Bake& bake);

/// Pages of the bake's atlas, of all light or of a layer, for view.html: with light for hidden
/// texels, and with alpha kDilatedAlpha where no surface lies, so that the page can leave out the
/// gutter, as transport::irradiance_at() does.
std::vector<image::Image> for_page(const Bake& bake, std::span<const Lent> lent,
                                   std::span<const image::Image> lightmaps);
inline constexpr float kDilatedAlpha = 0.25f;

}  // namespace luxel::pipeline
