// The error of light that rays pick up from texels.
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/solve/gather/budget/read_check.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

/// The light that rays pick up is bilinear between texels, and even beyond the last texel of a
/// chart. By how much of itself it may be off, as one standard error, as the texels' neighbours
/// show it: the sum of the texels' errors over the sum of what they send of light that has not been
/// reflected. An error acts like brighter or weaker lamps, and bounces multiply both alike. The
/// places where light varies, such as a lamp's surroundings or the edge of a shadow, are few, and
/// what they miss or add is missing or too much wherever rays see them. docs/method/gather.md
struct ByNeighbours {
  double error = 0;
  /// All light that texels send over that which has not been reflected before: what bounces make of
  /// an error that all texels share.
  double gain = 1;
};
/// `direct`: the part of E that comes straight from lights.
ByNeighbours error_by_neighbours(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                 const transport::Elements& elements, const TracedHits& hits,
                                 std::span<const Rgb> direct, std::span<const Rgb> irradiance);

/// By how much of itself gathered light is off since texels are as large as they are, as one
/// standard error.
struct TexelError {
  double safe = 0;                             ///< on the safe side: to be stated as a bound
  double likely = 0;                           ///< as it most likely is
  double gain = 1;                             ///< ByNeighbours
  double apart = 0;                            ///< the root of ReadError::square_apart
  std::vector<float> relative_square_apart{};  ///< ReadError
};
/// Before a measurement, the error is normal with error_by_neighbours(), which holds in most scenes
/// and is twice the truth in the middle of them. A measurement replaces it as far as it is the
/// surer one: the result is the root mean square of the product of both normal densities.
TexelError texel_error(const ByNeighbours& by_neighbours, ReadError measured);

}  // namespace luxel::gather
