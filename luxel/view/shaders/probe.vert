// A ball of two triangles for each part of its height and its girth.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/probe_shared.h"

layout(location = 0) out vec3 normal;
layout(location = 1) flat out uint probe;

const float pi = 3.14159265358979;
const uvec2 corners[6] = {uvec2(0, 0), uvec2(1, 0), uvec2(1, 1), uvec2(0, 0), uvec2(1, 1),
                          uvec2(0, 1)};

void main() {
  uint part = gl_VertexIndex / 6;
  vec2 at = vec2(uvec2(part % slices, part / slices) + corners[gl_VertexIndex % 6]);
  float round_about = 2 * pi * at.x / float(slices), down = pi * at.y / float(stacks);
  normal = vec3(sin(down) * cos(round_about), cos(down), sin(down) * sin(round_about));
  probe = gl_InstanceIndex;
  gl_Position = clip_from_world * vec4(probes.at[probe].position + normal * radius, 1);
}
