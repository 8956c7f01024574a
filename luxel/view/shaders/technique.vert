// Corners one by one. What is computed per vertex is computed for all three of the triangle, so that
// the pixel can multiply it by a colour of its own before it clips and interpolates.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "technique.glsl"

layout(location = 0) out vec2 at_map;
layout(location = 1) out vec2 at_metal;
layout(location = 2) out vec2 at_glow;
layout(location = 3) out vec2 at_through_share;
layout(location = 4) out vec3 tint;
layout(location = 5) out vec3 normal;
layout(location = 6) out vec3 to_viewer;
layout(location = 7) out vec3 place;
layout(location = 8) out vec3 light;    // E, or B per vertex
layout(location = 9) out vec3 weights;  // of the triangle's corners
layout(location = 10) flat out vec3 facing;
layout(location = 11) flat out vec3 highlight;
layout(location = 12) flat out uint item;
layout(location = 13) out float clear;

vec2 looked_up(LookUp look_up, Corner v) {
  vec3 uv = vec3(look_up.uv_set == 0 ? v.uv0 : v.uv1, 1);
  return vec2(dot(look_up.u, uv), dot(look_up.v, uv));
}

// 1 where the triangle's front is seen, -1 where its back is.
float side_of(uint first) {
  vec3 a = corners.at[first].position, b = corners.at[first + 1].position,
       c = corners.at[first + 2].position;
  vec3 towards = looking.is_parallel != 0 ? looking.back : looking.eye - a;
  return dot(cross(b - a, c - a), towards) < 0 ? -1 : 1;
}

void main() {
  Corner v = corners.at[gl_VertexIndex];
  Material m = materials.at[material];
  uint first = gl_VertexIndex / 3 * 3;
  // The back of a surface with two sides is lit as a front.
  float side = technique < normals ? side_of(first) : 1;
  gl_Position = clip_from_world * vec4(v.position, 1);
  at_map = looked_up(m.map, v);
  at_metal = looked_up(m.metal, v);
  at_glow = looked_up(m.glow, v);
  at_through_share = looked_up(m.through_share, v);
  tint = v.color;
  clear = v.clear;
  normal = v.normal * side;
  to_viewer = way_to_viewer(v.position);
  place = v.position;
  light = vec3(0);
  if (technique == radiosity || technique == radiosity_vertex) {
    LitElement e = elements.at[v.element];
    light = technique == radiosity ? e.irradiance : e.irradiance * e.reflectance;
  }
  weights = vec3(gl_VertexIndex == first, gl_VertexIndex == first + 1, gl_VertexIndex == first + 2);
  facing = highlight = vec3(0);
  if (technique == cad || technique == cas || technique == cads)
    for (uint k = 0; k < 3; ++k) {
      Corner at = corners.at[first + k];
      vec2 lit = lit_by_light(at.normal * side, way_to_viewer(at.position),
                              highlights.at[material].sharpness);
      facing[k] = lit.x, highlight[k] = lit.y;
    }
  item = v.item;
}
