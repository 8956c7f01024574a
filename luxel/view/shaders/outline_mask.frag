// What is outlined is white; holes of masks are not.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/shadow_shared.h"

layout(binding = 1) uniform sampler2D map;  // as surface.frag has it
layout(location = 0) in vec2 at_map;
layout(location = 1) in float clear;
layout(location = 0) out vec4 covered;

void main() {
  Material m = materials.at[material];
  if (texture(map, at_map).a * m.alpha * (1 - clear) < m.cutoff) discard;
  covered = vec4(1);
}
