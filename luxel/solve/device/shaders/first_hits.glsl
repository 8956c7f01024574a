// Makes the rays of elements and traces them. A work group has one cell of directions of 64
// elements, whose rays are alike: its threads each take an element, and its rays of that cell.
#include "element_rays.glsl"
layout(local_size_x = 64) in;

// Of 64 elements after each other: the first ray of each, the second of each and so on, in the order
// of cells.
layout(buffer_reference, scalar) writeonly buffer Hits { Hit at[]; };

layout(push_constant, scalar) uniform Push {
  World world;
  Elements elements;
  PlainCells plain;
  Hits hits;
  uvec2 seed;  // of all elements
  uint element_count, samples;
  uint first_group;  // 64 for each 64 elements
};

void main() {
  uint group = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  uint cell = group % kCells, tile = group / kCells, i = tile * 64 + lane;
  if (i >= element_count) return;
  Element e = elements.at[i];
  uvec2 own_seed = hash64(seed, uvec2(i, 0));
  uint plain_x = plain_eighths(own_seed.x), plain_y = plain_eighths(own_seed.y);
  uint place = first_place(plain, cell, samples, plain_x, plain_y);
  uint p = plain_cell(cell, plain_x, plain_y);
  for (uint k = plain.first_of[p]; k < plain.first_of[p + 1]; ++k, ++place) {
    Ray ray = Ray(e.origin, ray_direction(e, plain.sample_of[k], own_seed), 0, uintBitsToFloat(0x7f800000u));
    hits.at[(tile * samples + place) * 64 + lane] = trace(world, ray, false);
  }
}
