// A white ball in the light that a probe knows: E(n), as sh2_value() of luxel/base has it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/probe_shared.h"

layout(location = 0) in vec3 normal;
layout(location = 1) flat in uint probe;
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves

#include "false_color.glsl"

vec3 irradiance_at(vec3 n) {
  Probe p = probes.at[probe];
  float y[9] = {0.282094792,
                0.488602512 * n.y,
                0.488602512 * n.z,
                0.488602512 * n.x,
                1.092548431 * n.x * n.y,
                1.092548431 * n.y * n.z,
                0.315391565 * (3 * n.z * n.z - 1),
                1.092548431 * n.x * n.z,
                0.546274215 * (n.x * n.x - n.y * n.y)};
  vec3 sum = vec3(0);
  for (int k = 0; k < 9; ++k) sum += p.irradiance[k] * y[k];
  return max(sum, vec3(0));
}

void main() {
  vec3 e = irradiance_at(normalize(normal));
  vec3 color = e / pi * exposure;
  if (shows_false_colors != 0) color = false_color(value_of(e));
  seen = vec4(min(color, most), 1);
}
