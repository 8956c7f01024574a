// What rays see that have left the scene. A thread takes a slot, and its rays in their order: the sum
// is the same each time.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/see_through.glsl"
#include "slot_rays.glsl"
#include "stored_hits.glsl"
#include "surroundings.glsl"
layout(local_size_x = kRaysTogether) in;

// gather::EscapedLight
struct EscapedLight {
  vec3 sum;
  float luminance2, second_luminance;
};
OUT_BUFFER(AllLight, EscapedLight);
#include "luxel/solve/device/escaped_shared.h"

// Adds what a ray sees.
void add(Element e, uint sample_number, uvec2 seed, float weight, bool second_half, inout EscapedLight sum) {
  vec3 radiance = soft_radiance(around, ray_direction(e, sample_number, seed)) * weight;
  float l = luminance(radiance);
  sum.sum += radiance, sum.luminance2 += l * l;
  if (second_half) sum.second_luminance += l;
}

void main() {
  uint tile = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x, own = tile * kRaysTogether + lane;
  if (own >= slot_count) return;
  RaySlot slot = slots.at[own];
  Element e = elements.at[slot.element];
  uvec2 seed = seed_of_slot(slot, seeds);
  uvec2 plain = all_plain_eighths(seed);
  EscapedLight sum = EscapedLight(vec3(0), 0, 0);
  uint row = rows.at[tile];
  for (uint cell = 0; cell < kCells; ++cell) {
    uvec2 at = plain_place(cell, plain);
    uint doublings = doublings_of(shares, slot.shares, cell);
    uint first = slot.first << doublings, end = slot.end << doublings;
    for (uint block = first / kCells; block * kCells < end; ++block) {
      uint sample_number = sample_of_eighths(block, at.x, at.y);
      if (sample_number < first || sample_number >= end) continue;
      if (hits.at[row++ * kRaysTogether + lane] != uvec2(kEscaped, 0)) continue;
      add(e, sample_number, seed, uintBitsToFloat((127 - doublings) << 23), 2 * sample_number >= end, sum);
    }
  }
  light.at[own] = sum;
}
