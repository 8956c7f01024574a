// Sampling a triangle by the solid angle it covers, uniformly. [Arvo95] C++ and GLSL.
#ifndef LUXEL_LIGHT_BOTH_SPHERICAL_TRIANGLE_H
#define LUXEL_LIGHT_BOTH_SPHERICAL_TRIANGLE_H
#include "luxel/base/both_angle.h"
BOTH_BEGIN

// A triangle seen from a point: unit directions to its corners and the measures of the spherical
// triangle they span.
struct SphericalTriangle {
  vec3 a, b, c;
  float cos_c;        // cosine of the side between a and b, where sampling starts
  float alpha;        // dihedral angle at a [rad]
  float solid_angle;  // [sr]; 0 when degenerate
};

// The angle between two directions of any length [rad], precise for small ones, too.
BOTH float angle_between(vec3 a, vec3 b) { return arc_tangent(length(cross(a, b)), dot(a, b)); }

BOTH SphericalTriangle spherical_triangle(vec3 from, vec3 a, vec3 b, vec3 c) {
  SphericalTriangle t;
  t.a = unit_or_zero(a - from), t.b = unit_or_zero(b - from), t.c = unit_or_zero(c - from);
  const vec3 n_ab = cross(t.a, t.b), n_bc = cross(t.b, t.c), n_ca = cross(t.c, t.a);
  t.cos_c = dot(t.a, t.b);
  t.alpha = angle_between(n_ab, -n_ca);
  // The tangent form stays accurate for small triangles, where alpha + beta + gamma - pi cancels.
  const float numerator = abs(dot(t.a, cross(t.b, t.c)));
  const float denominator = 1 + dot(t.a, t.b) + dot(t.b, t.c) + dot(t.c, t.a);
  t.solid_angle = 2 * arc_tangent(numerator, denominator);  // [VanOosterom83]
  if (dot(n_ab, n_ab) == 0 || dot(n_bc, n_bc) == 0 || dot(n_ca, n_ca) == 0) t.solid_angle = 0;
  return t;
}

// The unit vector along the part of v that is orthogonal to the unit vector w.
BOTH vec3 orthogonal_part(vec3 v, vec3 w) { return unit_or_zero(v - w * dot(v, w)); }

// A unit direction with density 1 / solid_angle inside the triangle.
BOTH vec3 spherical_triangle_sample(SphericalTriangle triangle, vec2 u) {
  // A fraction u.x of the area lies between side (a, b) and the arc from b to c'.
  const float area = u.x * triangle.solid_angle;
  const vec2 turn = cos_and_sin(area - triangle.alpha), at_a = cos_and_sin(triangle.alpha);
  const float s = turn.y, t = turn.x;
  const float sin_alpha = at_a.y, cos_alpha = at_a.x;
  const float p = t - cos_alpha, q = s + sin_alpha * triangle.cos_c;
  const float numerator = (q * t - p * s) * cos_alpha - q;
  const float denominator = (q * s + p * t) * sin_alpha;
  const float cos_b =
      denominator != 0 ? clamp(numerator / denominator, -1.0f, 1.0f) : dot(triangle.a, triangle.c);
  const vec3 c_new = triangle.a * cos_b +
                     orthogonal_part(triangle.c, triangle.a) * sqrt(max(0.0f, 1 - cos_b * cos_b));
  const float z = 1 - u.y * (1 - dot(c_new, triangle.b));
  return triangle.b * z + orthogonal_part(c_new, triangle.b) * sqrt(max(0.0f, 1 - z * z));
}

BOTH_END
#endif
