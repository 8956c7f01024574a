#include "luxel/light/spherical_triangle.h"

#include <algorithm>

namespace luxel::light {
namespace {

float clamped_sqrt(float x) { return std::sqrt(std::max(0.0f, x)); }
/// The unit vector along the part of v that is orthogonal to the unit vector w.
Vec3 orthogonal_part(Vec3 v, Vec3 w) { return normalize(v - w * dot(v, w)); }

/// Angle between two planes through the origin with normals p and q.
}  // namespace

SphericalTriangle spherical_triangle(Vec3 from, Vec3 a, Vec3 b, Vec3 c) {
  SphericalTriangle t{normalize(a - from), normalize(b - from), normalize(c - from)};
  const Vec3 n_ab = cross(t.a, t.b), n_bc = cross(t.b, t.c), n_ca = cross(t.c, t.a);
  t.cos_c = dot(t.a, t.b);
  t.alpha = angle_between(n_ab, -n_ca);
  // The tangent form stays accurate for small triangles, where alpha + beta + gamma - pi cancels.
  const float numerator = std::abs(dot(t.a, cross(t.b, t.c)));
  const float denominator = 1 + dot(t.a, t.b) + dot(t.b, t.c) + dot(t.c, t.a);
  t.solid_angle = 2 * std::atan2(numerator, denominator);  // [VanOosterom83]
  if (dot(n_ab, n_ab) == 0 || dot(n_bc, n_bc) == 0 || dot(n_ca, n_ca) == 0) t.solid_angle = 0;
  return t;
}

Vec3 spherical_triangle_sample(const SphericalTriangle& triangle, Vec2 u) {
  // A fraction u.x of the area lies between side (a, b) and the arc from b to c'.
  const float area = u.x * triangle.solid_angle;
  const float s = std::sin(area - triangle.alpha), t = std::cos(area - triangle.alpha);
  const float sin_alpha = std::sin(triangle.alpha), cos_alpha = std::cos(triangle.alpha);
  const float p = t - cos_alpha, q = s + sin_alpha * triangle.cos_c;
  const float numerator = (q * t - p * s) * cos_alpha - q;
  const float denominator = (q * s + p * t) * sin_alpha;
  const float cos_b = denominator != 0 ? std::clamp(numerator / denominator, -1.0f, 1.0f)
                                       : dot(triangle.a, triangle.c);
  const Vec3 c_new = triangle.a * cos_b +
                     orthogonal_part(triangle.c, triangle.a) * clamped_sqrt(1 - cos_b * cos_b);
  const float z = 1 - u.y * (1 - dot(c_new, triangle.b));
  return triangle.b * z + orthogonal_part(c_new, triangle.b) * clamped_sqrt(1 - z * z);
}

Vec2 spherical_triangle_invert(const SphericalTriangle& triangle, Vec3 direction) {
  // c' is where the great circle from b through the direction meets the side (a, c).
  Vec3 c_new = normalize(cross(cross(triangle.b, direction), cross(triangle.c, triangle.a)));
  if (dot(c_new, triangle.a + triangle.c) < 0) c_new = -c_new;
  const SphericalTriangle part = spherical_triangle({}, triangle.a, triangle.b, c_new);
  const float reach = 1 - dot(c_new, triangle.b);
  return {std::clamp(part.solid_angle / triangle.solid_angle, 0.0f, 1.0f),
          reach > 0 ? std::clamp((1 - dot(direction, triangle.b)) / reach, 0.0f, 1.0f) : 0.0f};
}

}  // namespace luxel::light
