// Points of triangles. C++ and GLSL.
#ifndef LUXEL_BASE_BOTH_TRIANGLE_H
#define LUXEL_BASE_BOTH_TRIANGLE_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// Barycentric coordinates of corners 1 and 2 of a point uniform on a triangle, continuous in u.
// [Heitz19]
BOTH vec2 point_of_triangle(vec2 u) {
  if (u.y > u.x) {
    const float a = u.x * 0.5f;
    return vec2_of(a, u.y - a);
  }
  const float b = u.y * 0.5f;
  return vec2_of(u.x - b, b);
}

// The point itself, for such coordinates.
BOTH vec3 between_corners(vec3 a, vec3 b, vec3 c, vec2 at) {
  return a * (1.0f - at.x - at.y) + b * at.x + c * at.y;
}

BOTH_END
#endif
