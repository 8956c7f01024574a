#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/surface_shared.h"

layout(location = 0) centroid out vec2 at_light;
layout(location = 1) centroid out vec2 at_light_behind;
layout(location = 2) out vec2 at_map;
layout(location = 3) out vec2 at_metal;
layout(location = 4) out vec2 at_glow;
layout(location = 5) out vec2 at_through_share;
layout(location = 6) out vec2 at_through_tint;
layout(location = 7) out vec3 tint;
layout(location = 8) out vec3 from_eye;
layout(location = 9) centroid out vec3 from_eye_inside;
layout(location = 10) out vec3 normal;
layout(location = 11) flat out float turned;  // < 0 where the instance is mirrored
layout(location = 12) out float clear;

vec2 looked_up(LookUp look_up, Vertex v) {
  vec3 uv = vec3(look_up.uv_set == 0 ? v.uv0 : v.uv1, 1);
  return vec2(dot(look_up.u, uv), dot(look_up.v, uv));
}

// Where surfaces are from the eye, and what they face: light straight from lamps asks.
void set_place(Vertex v, Instance i, vec3 place) {
  from_eye = from_eye_inside = place - light_now.eye;
  vec3 a = vec3(i.row0.x, i.row1.x, i.row2.x), b = vec3(i.row0.y, i.row1.y, i.row2.y),
       c = vec3(i.row0.z, i.row1.z, i.row2.z);
  turned = dot(a, cross(b, c));
  normal = cross(b, c) * v.normal.x + cross(c, a) * v.normal.y + cross(a, b) * v.normal.z;
  if (turned < 0) normal = -normal;
}

void main() {
  Vertex v = vertices.at[gl_VertexIndex];
  Instance i = instances.at[instance];
  Material m = materials.at[material];
  vec4 p = vec4(v.position, 1);
  vec3 place = vec3(dot(i.row0, p), dot(i.row1, p), dot(i.row2, p));
  gl_Position = clip_from_world * vec4(place, 1);
  set_place(v, i, place);
  at_light = v.light;
  at_light_behind = v.light_behind;
  at_map = looked_up(m.map, v);
  at_metal = looked_up(m.metal, v);
  at_glow = looked_up(m.glow, v);
  at_through_share = looked_up(m.through_share, v);
  at_through_tint = looked_up(m.through_tint, v);
  tint = v.color;
  clear = v.clear;
}
