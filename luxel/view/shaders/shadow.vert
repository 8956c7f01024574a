// Surfaces as a lamp sees them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/shadow_shared.h"

layout(location = 0) out vec2 at_map;
layout(location = 1) out float clear;

void main() {
  Vertex v = vertices.at[gl_VertexIndex];
  Instance i = instances.at[instance];
  LookUp look_up = materials.at[material].map;
  vec4 p = vec4(v.position, 1);
  gl_Position = clip_from_world * vec4(dot(i.row0, p), dot(i.row1, p), dot(i.row2, p), 1);
  vec3 uv = vec3(look_up.uv_set == 0 ? v.uv0 : v.uv1, 1);
  at_map = vec2(dot(look_up.u, uv), dot(look_up.v, uv));
  clear = v.clear;
}
