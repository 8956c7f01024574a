// Corners of triangles, the weights of the second and third of them, and what is the same all over
// a triangle.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/quadratic_shared.h"

layout(location = 0) centroid out vec2 at;
layout(location = 1) flat out uvec2 group_and_sides;
layout(location = 2) flat out vec3 reflectance;
layout(location = 3) flat out vec3 emission;
layout(location = 4) flat out vec3 irradiance[6];

void main() {
  int triangle = gl_VertexIndex / 3, corner = gl_VertexIndex % 3;
  at = vec2(corner == 1, corner == 2);
  group_and_sides = uvec2(triangles.at[triangle].group, triangles.at[triangle].two_sided);
  reflectance = triangles.at[triangle].reflectance;
  emission = triangles.at[triangle].emission;
  for (int k = 0; k < 6; ++k) irradiance[k] = triangles.at[triangle].irradiance[k];
  gl_Position = clip_from_world * vec4(triangles.at[triangle].corner[corner], 1);
}
