// Light of an emissive triangle at a point, and points of the triangle to aim at. C++ and GLSL.
#ifndef LUXEL_LIGHT_BOTH_TRIANGLE_LIGHT_H
#define LUXEL_LIGHT_BOTH_TRIANGLE_LIGHT_H
#include "luxel/base/both_triangle.h"
#include "luxel/light/both_spherical_triangle.h"
#include "luxel/viewfactor/both_point_form_factor.h"
BOTH_BEGIN

// Up to so many triangles every one is looked at; of more, some are drawn.
const uint kMaxAllTriangles = 32;

// Corners counter-clockwise seen from the front, and what light::TriangleLight has of them.
struct LightTriangle {
  vec3 a, b, c;
  vec3 normal;  // unit, front side
  float area_m2;
  bool two_sided;
};

// pi F(point -> light): irradiance per unit of radiance, nothing in between. Zero in the light's
// own plane and behind a one-sided light.
BOTH float irradiance_per_radiance(LightTriangle light, vec3 position, vec3 normal) {
  const float side = dot(position - light.a, light.normal);
  const float reach = length(position - light.a);
  // In the light's plane, or in ours, rounding would decide between nothing and a half space.
  const float plane_tolerance = 1e-6f;
  if (abs(side) <= plane_tolerance * reach || (side < 0 && !light.two_sided)) return 0;
  const float highest = max(max(dot(light.a - position, normal), dot(light.b - position, normal)),
                            dot(light.c - position, normal));
  if (highest <= 10 * plane_tolerance * reach) return 0;
  const float pi = 3.14159265358979323846f;
  return pi * float(side > 0 ? point_to_triangle(position, normal, light.a, light.b, light.c)
                             : point_to_triangle(position, normal, light.a, light.c, light.b));
}

// One point of a light: w = cos (solid angle density) or cos cos / d^2 (area density); both up to a
// constant of the light, `measure`, which a group needs and an exact source does not.
struct LightPoint {
  vec3 target;
  vec2 at;  // barycentric coordinates of corners 1 and 2
  float weight, measure;
};

// Below it a triangle is so small that sampling its area is as good, and more exact in floats.
BOTH bool is_sampled_by_angle(SphericalTriangle spherical) { return spherical.solid_angle > 1e-3f; }

BOTH LightPoint point_by_angle(LightTriangle light, SphericalTriangle spherical, vec3 position,
                               vec3 normal, vec2 u) {
  const vec3 d = spherical_triangle_sample(spherical, u);
  const float along = dot(d, light.normal);
  const float t = along != 0 ? dot(light.a - position, light.normal) / along : 0.0f;
  const vec3 p = position + d * t;
  const vec3 ab = light.b - light.a, ac = light.c - light.a, ap = p - light.a;
  const vec3 n = cross(ab, ac);
  const float inverse = 1 / dot(n, n);
  LightPoint found;
  found.target = p;
  found.at = vec2_of(dot(cross(ap, ac), n) * inverse, dot(cross(ab, ap), n) * inverse);
  found.weight = max(0.0f, dot(d, normal));
  found.measure = spherical.solid_angle;
  return found;
}

BOTH LightPoint point_by_area(LightTriangle light, vec3 position, vec3 normal, vec2 u) {
  LightPoint found;
  found.at = point_of_triangle(u);
  found.target = between_corners(light.a, light.b, light.c, found.at);
  found.weight = 0, found.measure = light.area_m2;
  const vec3 d = found.target - position;
  const float d2 = dot(d, d);
  float light_side = -dot(d, light.normal);
  if (light.two_sided) light_side = abs(light_side);
  if (d2 > 0 && light_side > 0) found.weight = max(0.0f, dot(d, normal)) * light_side / (d2 * d2);
  return found;
}

BOTH LightPoint point_of_light(LightTriangle light, SphericalTriangle spherical, vec3 position,
                               vec3 normal, vec2 u) {
  if (is_sampled_by_angle(spherical)) return point_by_angle(light, spherical, position, normal, u);
  return point_by_area(light, position, normal, u);
}

BOTH_END
#endif
