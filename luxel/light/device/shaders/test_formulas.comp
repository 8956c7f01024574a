// What the formulas of luxel/light/both_*.h and luxel/base/both_angle.h are on a device, for inputs
// of ../formulas_test.cpp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/base/both_directions.h"
#include "luxel/light/both_bright_texel.h"
#include "luxel/light/both_light_group.h"
#include "luxel/light/both_punctual_light.h"
#include "luxel/light/both_triangle_light.h"
#include "luxel/light/device/test_support_shared.h"
layout(local_size_x = 64) in;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Question q = questions.at[i];
  LightTriangle light = LightTriangle(q.a, q.b, q.c, q.light_normal, 0.5 * length(cross(q.b - q.a, q.c - q.a)), true);
  SphericalTriangle spherical = spherical_triangle(q.position, q.a, q.b, q.c);
  LightPoint by_angle = point_by_angle(light, spherical, q.position, q.normal, q.u);
  LightPoint by_area = point_by_area(light, q.position, q.normal, q.u);
  LightGroup group = LightGroup(q.a, q.u.x, 2, q.light_normal, 0.1, q.light_normal, 0.6, 0.8, 5);
  Answer answer;
  answer.by_angle = by_angle.target, answer.at = by_angle.at;
  answer.weight_by_angle = by_angle.weight, answer.measure_by_angle = by_angle.measure;
  answer.by_area = by_area.target, answer.weight_by_area = by_area.weight;
  answer.column = direction_in_column(64, 0.3, int(q.u.x * 64), q.u.y, double(q.direction.y));
  answer.angle = cos_and_sin(q.angle);
  answer.arc_tangent = arc_tangent(q.direction.x, q.direction.y);
  answer.irradiance = irradiance_per_radiance(light, q.position, q.normal);
  answer.factor = point_to_triangle(q.position, q.normal, q.a, q.b, q.c);
  answer.importance = importance_of(group, q.position, q.normal);
  answer.at_distance = share_at_distance(q.distance_m, 3);
  answer.in_cone = share_in_cone(q.direction.y, 0.8, 0.5);
  answer.in_disc = direction_in_disc(0.1, q.u, unit_circle(q.u.x));
  answer.folded = folded_cosine(q.direction, q.normal, q.geometric_normal);
  answers.at[i] = answer;
}
