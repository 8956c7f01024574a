// Whether anything lies on each ray.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "hierarchy.glsl"
layout(local_size_x = 64) in;

layout(buffer_reference, scalar) writeonly buffer Blocked { uint at[]; };

layout(push_constant, scalar) uniform Push {
  World world;
  Vectors rays;
  Blocked blocked;
  uint first, end;  // of the rays that are traced
};

void main() {
  uint i = first + gl_GlobalInvocationID.x;
  if (i >= end) return;
  blocked.at[i] = uint(trace(world, ray_at(rays, i), true).number != kNoTriangle);
}
