// Corners of triangles, and the weights of the second and third of them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "quadratic.glsl"

layout(location = 0) centroid out vec2 at;
layout(location = 1) flat out uint triangle;

void main() {
  triangle = gl_VertexIndex / 3;
  int corner = gl_VertexIndex % 3;
  at = vec2(corner == 1, corner == 2);
  gl_Position = clip_from_world * vec4(triangles.at[triangle].corner[corner], 1);
}
