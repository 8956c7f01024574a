// How far light found on a device is from that of the processor.
#pragma once

#include <cmath>
#include <span>

namespace luxel::device {

/// Differences of elements' light: root mean square, and of the sums, over the mean.
struct Differences {
  double rms = 0, bias = 0;
};
inline Differences differences(std::span<const float> found, std::span<const float> expected) {
  double sum = 0, difference = 0, squares = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    const double d = double(found[i]) - double(expected[i]);
    sum += double(expected[i]), difference += d, squares += d * d;
  }
  const double n = double(found.size());
  return {std::sqrt(squares / n) / (sum / n), std::abs(difference) / sum};
}

}  // namespace luxel::device
