// Makes the rays of elements and traces them. A work group has one cell of directions of 64
// elements, whose rays are alike: its threads each take an element, and its rays of that cell.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "luxel/solve/device/first_hits_shared.h"
#include "element_rays.glsl"
layout(local_size_x = kRaysTogether) in;

void main() {
  uint group = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  uint cell = group % kCells, tile = group / kCells, i = tile * kRaysTogether + lane;
  if (i >= element_count) return;
  Element e = elements.at[i];
  uvec2 own_seed = hash64(seed, uvec2(i, 0));
  uvec2 plain = all_plain_eighths(own_seed), at = plain_place(cell, plain);
  uint place = first_of_cell(cell, 0, samples, plain);
  for (uint block = 0; block * kCells < samples; ++block) {
    uint sample_number = sample_of_eighths(block, at.x, at.y);
    if (sample_number >= samples) continue;
    Ray ray = Ray(e.origin, ray_direction(e, sample_number, own_seed), 0, uintBitsToFloat(0x7f800000u));
    hits.at[(tile * samples + place++) * kRaysTogether + lane] = trace(world, ray, false);
  }
}
