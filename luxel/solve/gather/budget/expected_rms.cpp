#include "luxel/solve/gather/budget/expected_rms.h"

namespace luxel::gather {

ExpectedSquares expected_squares(std::span<const Rgb> irradiance, const SafeVariances& variance,
                                 const TracedHits& hits) {
  double mean = 0, noise = 0, texels = 0, count = 0;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    if (is_hidden(hits, i)) continue;
    mean += double(luminance(irradiance[i]));
    noise += double(variance.noise[i]);
    texels += double(variance.all[i]) - double(variance.noise[i]);
    count += 1;
  }
  if (!(mean > 0)) return {};
  // Means over the square of the mean light.
  const double factor = count / (mean * mean);
  return {kOfNoise * noise * factor, variance.likely_of_texels * texels * factor};
}

}  // namespace luxel::gather
