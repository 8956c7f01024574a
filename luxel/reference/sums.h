// Sums of independent values, the mean that they stand for, and how well it is known.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::reference {

/// Sums of colours and of their luminance, with squares. In double, which adds up 2^29 floats of
/// one size without a rounding.
struct Sums {
  double r = 0, g = 0, b = 0, l = 0;
  double r2 = 0, g2 = 0, b2 = 0, l2 = 0;

  void add(Rgb value) {
    const double x = double(value.x), y = double(value.y), z = double(value.z);
    const double y_lum = double(luminance(value));
    r += x, g += y, b += z, l += y_lum;
    r2 += x * x, g2 += y * y, b2 += z * z, l2 += y_lum * y_lum;
  }
  void add(const Sums& other) {
    r += other.r, g += other.g, b += other.b, l += other.l;
    r2 += other.r2, g2 += other.g2, b2 += other.b2, l2 += other.l2;
  }
};

/// sqrt(s^2 / n), s^2 the unbiased estimate of the variance. One value says nothing about its own
/// error: it counts as wholly uncertain.
inline double standard_error(double sum, double sum2, double n) {
  if (n < 2) return std::abs(sum);
  const double variance = (sum2 - sum * sum / n) / (n - 1);
  return variance < 0 ? 0 : std::sqrt(variance / n);
}
inline Rgb mean_of(const Sums& s, double n) {
  return {float(s.r / n), float(s.g / n), float(s.b / n)};
}
inline Rgb error_of(const Sums& s, double n) {
  return {float(standard_error(s.r, s.r2, n)), float(standard_error(s.g, s.g2, n)),
          float(standard_error(s.b, s.b2, n))};
}

/// Root mean square of errors over a mean whose sum over as many is given; 0 where that is not
/// above 0.
inline double relative_error(std::span<const float> errors, double sum_of_luminance) {
  double sum2 = 0;
  for (const float e : errors) sum2 += double(e) * double(e);
  return sum_of_luminance > 0 ? std::sqrt(sum2 * double(errors.size())) / sum_of_luminance : 0;
}

}  // namespace luxel::reference
