// What it costs that rays pick light up from texels.
#pragma once

#include <span>

#include "luxel/atlas/atlas.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

/// The light that rays pick up is bilinear between texels, and even beyond the last texel of a
/// chart. By how much of itself it may be off, as one standard error: the sum of the texels'
/// errors, as their neighbours show them, over the sum of what they send. The places where light
/// varies, such as a lamp's surroundings or the edge of a shadow, are few, and what they miss or
/// add is missing or too much wherever rays see them. docs/method/gather.md
double texel_error(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                   const transport::Elements& elements, const TracedHits& hits,
                   std::span<const Rgb> irradiance);

}  // namespace luxel::gather
