#include "luxel/solve/gather/budget/expected_rms.h"

#include <cmath>

namespace luxel::gather {
namespace {

constexpr double kOfNoise = 0.70710678;

}  // namespace

double expected_rms(std::span<const Rgb> irradiance, const SafeVariances& variance,
                    const TracedHits& hits) {
  double mean = 0, sum = 0, count = 0;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    if (is_hidden(hits, i)) continue;
    const double noise = double(variance.noise[i]), texels = double(variance.all[i]) - noise;
    mean += double(luminance(irradiance[i])),
        sum += kOfNoise * noise + variance.likely_of_texels * texels;
    count += 1;
  }
  return mean > 0 ? std::sqrt(sum * count) / mean : 0;
}

}  // namespace luxel::gather
