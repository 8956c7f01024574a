// E straight from lamps at points of surfaces.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(binding = 0) uniform sampler2DShadow shadow_maps;
layout(binding = 1) uniform sampler2D shadow_depth;

#include "luxel/view/draw/points_shared.h"

layout(local_size_x = kPointThreads) in;
layout(constant_id = 0) const uint lamps_drawn = 2;

// Over a turn, by the golden ratio.
float turn_of_place() { return 6.28318531 * fract(float(gl_GlobalInvocationID.x) * 0.61803399); }

#include "direct.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  LitPoint p = points.at[i];
  irradiance.at[i] = direct_light(p.position, p.normal, p.normal);
}
