// The noise of texels, by their solver's statements and by the differences that they show.
#pragma once

#include "luxel/post/neighbours.h"

namespace luxel::post {

struct NoiseLevel {
  std::vector<float> variance;   ///< of luminance, per texel; 0: no noise around it
  std::vector<Rgb> per_channel;  ///< variance of each channel over that of luminance
};

/// Units of Progress per texel; as kNeighbourhoodUnits.
inline constexpr uint64_t kNoiseLevelUnits = 50;

/// A solver's variances are estimates themselves, and gather's are upper bounds: it takes
/// stratified samples for independent ones. The noise of neighbours is independent, however, so
/// their mixed second difference
///
///       1 -2  1
///   r = -2 4 -2  / 6
///       1 -2  1
///
/// [Immerkaer96] has the variance of one texel and holds nothing of light that is the sum of a
/// function of x and one of y. The median of r^2 over what is stated for it, taken around each
/// texel, says by how much the statement is too large; edges of light, which fill less than half
/// of the window, do not move it. It is never taken to be too small. Members of a team share the
/// texels out; null: there is none. Errors: cancelled, another member gives up.
Result<NoiseLevel> noise_level(const Neighbourhood& n, std::span<const Rgb> values,
                               std::span<const float> variance, Team* team, Progress& progress);

}  // namespace luxel::post
