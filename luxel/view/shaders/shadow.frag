// Holes of masks let light through.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/shadow_shared.h"

layout(binding = 0) uniform sampler2D map;
layout(location = 0) in vec2 at_map;
layout(location = 1) in float clear;

void main() {
  Material m = materials.at[material];
  if (texture(map, at_map).a * m.alpha * (1 - clear) < m.cutoff) discard;
}
