// What the rays of elements see that have left the scene. A thread takes an element, and its rays in
// their order: the sum is the same each time. ../landed_rays.h has the structs.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/see_through.glsl"
#include "element_rays.glsl"
#include "stored_hits.glsl"
#include "surroundings.glsl"
layout(local_size_x = 64) in;

// gather::EscapedLight
struct EscapedLight {
  vec3 sum;
  float luminance2, second_luminance;
};
layout(buffer_reference, scalar) writeonly buffer AllLight { EscapedLight at[]; };
layout(push_constant, scalar) uniform Push {
  Surroundings around;
  Elements elements;
  PlainCells plain;
  StoredHits hits;  // of the chunk
  AllLight light;  // of the chunk's elements
  uvec2 seed;
  uint element_count, samples;
  uint first_tile;  // of the chunk
  uint first_group;
};

void main() {
  uint tile = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  uint own = tile * 64 + lane, i = first_tile * 64 + own;
  if (i >= element_count) return;
  Element e = elements.at[i];
  uvec2 own_seed = hash64(seed, uvec2(i, 0));
  uint plain_x = plain_eighths(own_seed.x), plain_y = plain_eighths(own_seed.y);
  EscapedLight sum = EscapedLight(vec3(0), 0, 0);
  uint place = 0;
  for (uint cell = 0; cell < kCells; ++cell) {
    uint p = plain_cell(cell, plain_x, plain_y);
    for (uint k = plain.first_of[p]; k < plain.first_of[p + 1]; ++k, ++place) {
      if (hits.at[(tile * samples + place) * 64 + lane] != uvec2(kEscaped, 0)) continue;
      uint sample_number = plain.sample_of[k];
      vec3 radiance = soft_radiance(around, ray_direction(e, sample_number, own_seed));
      float l = luminance(radiance);
      sum.sum += radiance, sum.luminance2 += l * l;
      if (2 * sample_number >= samples) sum.second_luminance += l;
    }
  }
  light.at[own] = sum;
}
