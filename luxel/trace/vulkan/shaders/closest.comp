// What each ray meets first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "hierarchy.glsl"
layout(local_size_x = 64) in;

layout(buffer_reference, scalar) writeonly buffer Hits { Hit at[]; };

layout(push_constant, scalar) uniform Push {
  World world;
  Vectors rays;
  Hits hits;
  uint first, end;  // of the rays that are traced
};

void main() {
  uint i = first + gl_GlobalInvocationID.x;
  if (i >= end) return;
  hits.at[i] = trace(world, ray_at(rays, i), false);
}
