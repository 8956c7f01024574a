// A solver's light without its grain: what `luxel bake --denoise` adds.
#pragma once

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// Filters the direct part and the rest apart, for the edges of shadows are in the one and most of
/// the noise is in the other. Light stays within each of `regions` (connected_texels(), or none),
/// so none gets into a closed room. Texels whose direct light looks like a firefly get kLookAgain
/// times the shadow rays of settings. Light with answers gets its delivered_error. Members of a
/// team share the texels out. Errors: cancelled, another member of the team gives up.
Status denoise_light(const light::TexelScene& in, const BakeSettings& settings,
                     std::span<const uint32_t> regions, TexelLight& light, Progress& progress,
                     Team* team = nullptr);
inline constexpr int kLookAgain = 16;

}  // namespace luxel::pipeline
