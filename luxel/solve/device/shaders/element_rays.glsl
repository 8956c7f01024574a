// The rays that an element sends out: luxel/solve/gather/rays/element_rays.h.
#extension GL_GOOGLE_include_directive : require
#include "luxel/base/both_directions.h"
#include "luxel/base/both_sobol.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

const uint kCellsPerAxis = 8, kCells = 64;

struct Element {
  vec3 origin;  // off the surface
  vec3 normal, geometric_normal;
};
layout(buffer_reference, scalar) readonly buffer Elements { Element at[]; };

// Samples by the cell in which they lie before they are scrambled.
layout(buffer_reference, scalar) readonly buffer PlainCells {
  uint first_of[kCells + 1];
  uint sample_of[];
};

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

// Cells are numbered in Morton order: x has bits 0, 2, 4.
uint plain_cell(uint cell, uint plain_x, uint plain_y) {
  uint x = (cell & 1) | (cell >> 1 & 2) | (cell >> 2 & 4), y = (cell >> 1 & 1) | (cell >> 2 & 2) | (cell >> 3 & 4);
  x = plain_x >> 3 * x & 7, y = plain_y >> 3 * y & 7;
  return (x & 1) | (x & 2) << 1 | (x & 4) << 2 | ((y & 1) | (y & 2) << 1 | (y & 4) << 2) << 1;
}

// Where the rays of a cell begin among an element's: so many lie in the cells before it.
uint first_place(PlainCells plain, uint cell, uint samples, uint plain_x, uint plain_y) {
  if (samples % kCells == 0) return samples / kCells * cell;
  uint place = 0;
  for (uint c = 0; c < cell; ++c) {
    uint p = plain_cell(c, plain_x, plain_y);
    place += plain.first_of[p + 1] - plain.first_of[p];
  }
  return place;
}
