// E straight from lamps at points of surfaces. luxel/view/draw/light_at_points.h has the structs.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(local_size_x = 64) in;
layout(binding = 0) uniform sampler2DShadow shadow_maps;
layout(binding = 1) uniform sampler2D shadow_depth;

struct Point {
  vec3 position, normal;
};
layout(buffer_reference, scalar) readonly buffer Points { Point at[]; };
layout(buffer_reference, scalar) writeonly buffer Irradiance { vec3 at[]; };

layout(push_constant, scalar) uniform Push {
  LightNow light_now;
  Points points;
  Irradiance irradiance;
  uint count;
};

layout(constant_id = 0) const uint lamps_drawn = 2;

// Over a turn, by the golden ratio.
float turn_of_place() { return 6.28318531 * fract(float(gl_GlobalInvocationID.x) * 0.61803399); }

#include "direct.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Point p = points.at[i];
  irradiance.at[i] = direct_light(p.position, p.normal, p.normal);
}
