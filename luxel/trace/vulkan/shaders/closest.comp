// What each ray meets first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "hierarchy.glsl"
layout(local_size_x = 64) in;

OUT_BUFFER(Answers, Hit);
#include "luxel/trace/vulkan/trace_push_shared.h"

void main() {
  uint i = first + gl_GlobalInvocationID.x;
  if (i >= end) return;
  answers.at[i] = trace(world, ray_at(rays, i), false);
}
