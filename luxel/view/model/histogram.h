// Histogram of a picture's brightness.
#pragma once

#include <vector>

#include "luxel/image/image.h"

namespace luxel::view {

/// Luminance by quarter stops, from kDarkestStop to kBrightestStop: stop 0 is what the exposure
/// brings to 1. Darker and brighter pixels are in the first and the last bin.
struct Histogram {
  std::vector<float> shares;  ///< of the pixels, per bin, from dark to bright
  float median = 0;           ///< luminance that half of the pixels stay below
  float p95 = 0;              ///< that 95 % stay below
  float mean = 0;
  float over = 0;  ///< share of the pixels whose exposed luminance is above 1
};
inline constexpr int kDarkestStop = -10, kBrightestStop = 4, kBinsPerStop = 4;
inline constexpr int kHistogramBins = (kBrightestStop - kDarkestStop) * kBinsPerStop;

/// Pixels that are black do not count. All 0 where no others are.
Histogram histogram_of(const image::Image& radiance, float exposure);

}  // namespace luxel::view
