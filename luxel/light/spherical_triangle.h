// Sampling a triangle by the solid angle it covers, uniformly. [Arvo95]
#pragma once

#include "luxel/base/vec.h"
#include "luxel/light/both_spherical_triangle.h"

namespace luxel::light {

using both::angle_between;
using both::spherical_triangle;
using both::spherical_triangle_sample;
using both::SphericalTriangle;

/// [1/sr]
inline float spherical_triangle_pdf_solid_angle(const SphericalTriangle& triangle) {
  return 1.0f / triangle.solid_angle;
}
/// The u that spherical_triangle_sample maps to `direction`, which lies in the triangle.
Vec2 spherical_triangle_invert(const SphericalTriangle& triangle, Vec3 direction);

}  // namespace luxel::light
