#include "luxel/view/model/histogram.h"

#include <algorithm>
#include <cmath>

namespace luxel::view {
namespace {

size_t bin_of(float exposed) {
  const float stop = std::log2(exposed);
  return size_t(
      std::clamp(int(std::floor((stop - kDarkestStop) * kBinsPerStop)), 0, kHistogramBins - 1));
}

/// Rearranges the values.
float quantile_of(std::vector<float>& values, double q) {
  const auto at = std::ptrdiff_t(q * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[size_t(at)];
}

}  // namespace

Histogram histogram_of(const image::Image& radiance, float exposure) {
  Histogram out;
  out.shares.assign(kHistogramBins, 0);
  std::vector<float> values;
  double sum = 0, over = 0;
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x) {
      const float value = luminance(radiance.rgb(x, y));
      if (!(value > 0)) continue;
      values.push_back(value);
      sum += double(value);
      over += value * exposure > 1;
      out.shares[bin_of(value * exposure)] += 1;
    }
  if (values.empty()) return out;
  const auto count = double(values.size());
  for (float& share : out.shares) share = float(double(share) / count);
  out.mean = float(sum / count), out.over = float(over / count);
  out.median = quantile_of(values, 0.5);
  out.p95 = quantile_of(values, 0.95);
  return out;
}

}  // namespace luxel::view
