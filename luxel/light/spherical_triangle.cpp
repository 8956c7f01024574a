#include "luxel/light/spherical_triangle.h"

#include <algorithm>

namespace luxel::light {

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
