// Directions about a normal. C++ and GLSL.
#ifndef LUXEL_BASE_BOTH_DIRECTIONS_H
#define LUXEL_BASE_BOTH_DIRECTIONS_H
#include "luxel/base/both_circle.h"
BOTH_BEGIN

// The direction about +z that a point of the unit square stands for, with the density of the
// cosine.
BOTH vec3 cosine_direction(float u, float v) {
  const vec2 circle = unit_circle(u);
  const float r = sqrt(v);
  return vec3_of(circle.x * r, circle.y * r, sqrt(1 - v));
}

// A direction below the plane of the geometric normal is mirrored to above it.
BOTH vec3 mirrored_above(vec3 direction, vec3 geometric_normal) {
  const float above = dot(direction, geometric_normal);
  return above < 0 ? direction + geometric_normal * (-2 * above) : direction;
}

// The cosine with which light from `direction` counts at a point whose shading normal differs from
// that of its triangle: directions below the triangle look at their mirror image above it, so that
// they see light, not the inside of the solid. Its integral over the hemisphere is pi.
BOTH float folded_cosine(vec3 direction, vec3 normal, vec3 geometric_normal) {
  const float cosine = max(0.0f, dot(direction, normal));
  if (normal == geometric_normal) return cosine;
  const vec3 mirrored = direction - geometric_normal * (2 * dot(direction, geometric_normal));
  return cosine + max(0.0f, dot(mirrored, normal));
}

BOTH_END
#endif
