// Sampling a triangle by the solid angle it covers, uniformly. [Arvo95]
#pragma once

#include <cmath>

#include "luxel/base/vec.h"

namespace luxel::light {

/// The angle between two directions of any length [rad], precise for small ones, too.
inline float angle_between(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

/// A triangle seen from a point: unit directions to its corners and the measures of the spherical
/// triangle they span.
struct SphericalTriangle {
  Vec3 a, b, c;
  float cos_c = 0;        ///< cosine of the side between a and b, where sampling starts
  float alpha = 0;        ///< dihedral angle at a [rad]
  float solid_angle = 0;  ///< [sr]; 0 when degenerate
};
SphericalTriangle spherical_triangle(Vec3 from, Vec3 a, Vec3 b, Vec3 c);

/// A unit direction with density 1 / solid_angle inside the triangle.
Vec3 spherical_triangle_sample(const SphericalTriangle& triangle, Vec2 u);
/// [1/sr]
inline float spherical_triangle_pdf_solid_angle(const SphericalTriangle& triangle) {
  return 1.0f / triangle.solid_angle;
}
/// The u that spherical_triangle_sample maps to `direction`, which lies in the triangle.
Vec2 spherical_triangle_invert(const SphericalTriangle& triangle, Vec3 direction);

}  // namespace luxel::light
