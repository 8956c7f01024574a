// Maps from the unit square to directions: sample, density and inverse stand together.
#pragma once

#include "luxel/base/both_triangle.h"
#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

/// A direction about +z with density cos(theta) / pi. (Paper 000 prints this formula with a slip;
/// see docs/method/gather.md.)
inline Vec3 cosine_hemisphere_sample(Vec2 u) {
  const float r = std::sqrt(u.y);
  const float phi = 2 * kPi * u.x;
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - u.y))};
}
/// [1/sr]
inline float cosine_hemisphere_pdf_solid_angle(float cos_theta) {
  return std::max(0.0f, cos_theta) / kPi;
}
inline Vec2 cosine_hemisphere_invert(Vec3 direction) {
  const float phi = std::atan2(direction.y, direction.x) / (2 * kPi);
  return {phi < 0 ? phi + 1 : phi, direction.x * direction.x + direction.y * direction.y};
}

/// A direction uniform over the sphere.
inline Vec3 uniform_sphere_sample(Vec2 u) {
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Barycentric coordinates of a point uniform on a triangle, continuous in u. [Heitz19]
inline Barycentric triangle_sample(Vec2 u) {
  const Vec2 at = both::point_of_triangle(u);
  return {at.x, at.y};
}
/// [1/m^2]
inline float triangle_pdf_area(float area_m2) { return 1.0f / area_m2; }

}  // namespace base
}  // namespace luxel
