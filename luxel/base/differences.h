// Differences of values from expected ones.
#pragma once

#include <cmath>
#include <span>

namespace luxel {
inline namespace base {

/// Over the mean of the expected values.
struct Differences {
  double rms = 0;   ///< root mean square
  double bias = 0;  ///< of the sums: above 0 where there is more than expected
};
/// As many of either, of which the expected ones are not all 0.
inline Differences differences(std::span<const float> found, std::span<const float> expected) {
  double sum = 0, difference = 0, squares = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    const double d = double(found[i]) - double(expected[i]);
    sum += double(expected[i]), difference += d, squares += d * d;
  }
  const double n = double(found.size());
  return {std::sqrt(squares / n) / (sum / n), difference / sum};
}

}  // namespace base
}  // namespace luxel
