// Rays of elements, sample for sample those of the processor: luxel/solve/gather/rays/element_rays.h.
#extension GL_GOOGLE_include_directive : require
#include "luxel/base/both_directions.h"
#include "luxel/base/both_sobol.h"
#include "luxel/solve/device/rays_shared.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

const uint kCellsPerAxis = 8, kCells = 64;

vec3 ray_direction(Element e, uint sample_number, uvec2 seed) {
  float u = unit_float(reverse_bits(scramble_upwards(sample_number, seed.x)));
  float v = unit_float(reverse_bits(scramble_upwards(sobol_second_reversed(sample_number), seed.y)));
  vec3 d = to_world(e.normal, cosine_direction(u, v));
  return e.normal == e.geometric_normal ? d : mirrored_above(d, e.geometric_normal);
}

// Per eighth of an axis, three bits each: the one that scrambling moves there.
uint plain_eighths(uint seed) {
  uint plain = 0;
  for (uint k = 0; k < kCellsPerAxis; ++k)
    plain |= reverse_3_bits(k) << 3 * reverse_3_bits(scramble_upwards(k, seed) & 7);
  return plain;
}
uvec2 all_plain_eighths(uvec2 seed) { return uvec2(plain_eighths(seed.x), plain_eighths(seed.y)); }

// The column and the row in which the samples of a cell lie before they are scrambled. Cells are
// numbered in Morton order: x has bits 0, 2, 4.
uvec2 plain_place(uint cell, uvec2 plain) {
  uint x = (cell & 1) | (cell >> 1 & 2) | (cell >> 2 & 4), y = (cell >> 1 & 1) | (cell >> 2 & 2) | (cell >> 3 & 4);
  return uvec2(plain.x >> 3 * x & 7, plain.y >> 3 * y & 7);
}

// How many samples below `end` lie there. Each 64 have one.
uint samples_below(uint end, uvec2 place) {
  uint block = end / kCells;
  return block + (sample_of_eighths(block, place.x, place.y) < end ? 1 : 0);
}

// Where the rays of a cell begin among those of an element's samples [first, end): so many lie in
// the cells before it.
uint first_of_cell(uint cell, uint first, uint end, uvec2 plain) {
  if ((first | end) % kCells == 0) return (end - first) / kCells * cell;
  uint count = 0;
  for (uint c = 0; c < cell; ++c) {
    uvec2 place = plain_place(c, plain);
    count += samples_below(end, place) - samples_below(first, place);
  }
  return count;
}
