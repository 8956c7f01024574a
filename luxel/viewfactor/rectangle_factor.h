// The view factor of a rectangle in closed form, for scenes and tests whose answer must not come
// from the kernels under test.
#pragma once

#include <cmath>

#include "luxel/base/vec_double.h"

namespace luxel::viewfactor {

/// From a point at the origin that looks up (+y) to the rectangle [x0, x1] x [z0, z1] in the plane
/// y = height > 0, seen from below: four corner rectangles, each Howell's B-3. Metres.
inline double rectangle_factor(double x0, double x1, double z0, double z1, double height) {
  const auto corner = [&](double x, double z) {
    const double a = x / height, b = z / height;
    const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * kPiDouble);
  };
  return corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0);
}

}  // namespace luxel::viewfactor
