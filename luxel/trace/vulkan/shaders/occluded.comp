// Whether anything lies on each ray.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "hierarchy.glsl"
layout(local_size_x = 64) in;

OUT_BUFFER(Answers, uint);
#include "luxel/trace/vulkan/trace_push_shared.h"

void main() {
  uint i = first + gl_GlobalInvocationID.x;
  if (i >= end) return;
  answers.at[i] = uint(trace(world, ray_at(rays, i), true).number != kNoTriangle);
}
