// Real spherical harmonics up to the second band, nine functions over the sphere.
#pragma once

#include <array>

#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

/// Number of functions of bands 0 to 2, in the order (0,0) (1,-1) (1,0) (1,1) (2,-2) ... (2,2).
inline constexpr size_t kSh2 = 9;

/// Their values at a unit direction; orthonormal over the sphere, without the Condon-Shortley sign:
/// (1, y, z, x, xy, yz, 3 z^2 - 1, xz, x^2 - y^2), each times its constant. [Ramamoorthi01, eq. 3]
inline std::array<float, kSh2> sh2_basis(Vec3 d) {
  return {0.282094792f,
          0.488602512f * d.y,
          0.488602512f * d.z,
          0.488602512f * d.x,
          1.092548431f * d.x * d.y,
          1.092548431f * d.y * d.z,
          0.315391565f * (3 * d.z * d.z - 1),
          1.092548431f * d.x * d.z,
          0.546274215f * (d.x * d.x - d.y * d.y)};
}

/// sum of c_k Y_k(d)
inline Rgb sh2_value(const std::array<Rgb, kSh2>& c, Vec3 d) {
  const std::array<float, kSh2> y = sh2_basis(d);
  Rgb sum{};
  for (size_t k = 0; k < kSh2; ++k) sum += c[k] * y[k];
  return sum;
}

/// The k-th of n directions that are spread evenly over the sphere, along a spiral. [Keinert15]
inline Vec3 spiral_direction(uint32_t k, uint32_t n) {
  constexpr double kGoldenAngle = 2.39996322972865332;
  const double z = 1 - (2 * double(k) + 1) / double(n), phi = kGoldenAngle * double(k);
  const double r = std::sqrt(1 - z * z);
  return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
}

}  // namespace base
}  // namespace luxel
