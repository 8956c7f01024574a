// Corners one by one, so that each triangle has its own.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/overlay_shared.h"

layout(location = 0) centroid out vec2 at_light;
layout(location = 1) out vec2 at_map;
layout(location = 2) out vec2 at_atlas;
layout(location = 3) out vec3 position;
layout(location = 4) out vec3 weights;  // of the triangle's corners
layout(location = 5) flat out uint chart;
layout(location = 6) out float clear;

void main() {
  Vertex v = vertices.at[look.corners.at[gl_VertexIndex]];
  Instance i = instances.at[instance];
  Material m = materials.at[material];
  vec4 p = vec4(v.position, 1);
  position = vec3(dot(i.row0, p), dot(i.row1, p), dot(i.row2, p));
  gl_Position = clip_from_world * vec4(position, 1);
  at_light = at_atlas = v.light;
  vec3 uv = vec3(m.map.uv_set == 0 ? v.uv0 : v.uv1, 1);
  at_map = vec2(dot(m.map.u, uv), dot(m.map.v, uv));
  uint corner = gl_VertexIndex % 3;
  weights = vec3(corner == 0, corner == 1, corner == 2);
  clear = v.clear;
  chart = look.charts.at[gl_VertexIndex / 3];
}
