// Texels in which direct light varies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/light/supersample.h"

namespace luxel::light {

struct UnevenTexels {
  std::vector<uint32_t> texels;  ///< in the order of the map
  uint64_t rays = 0;             ///< that found them
};
/// Those texels of `among`, which is in the order of the map, that are uneven, or at a chart's
/// border or in the light of a punctual light with light that differs between their points. Errors:
/// cancelled.
Result<UnevenTexels> texels_to_average(const TexelScene& in, std::span<const uint32_t> among,
                                       const SupersampleParams& params, const DirectLight& direct,
                                       Progress& progress);

}  // namespace luxel::light
