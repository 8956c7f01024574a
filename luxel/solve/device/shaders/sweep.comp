// Adds what elements gather from the map at the places where the rays of one round have landed. A
// thread takes a slot. luxel/solve/gather/bounce/sweep.h, ../device_sweep.h
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/solve/device/sweep_shared.h"
#include "stored_hits.glsl"
layout(local_size_x = kRaysTogether) in;

// gather::lookup()
vec3 lookup(uvec2 hit) {
  LookupPlace p = place_of(hit);
  vec4 upper = map.at[p.base] * (1 - p.f.x) + map.at[p.base + 1] * p.f.x;
  uint below = p.base + map_stride;
  vec4 lower = map.at[below] * (1 - p.f.x) + map.at[below + 1] * p.f.x;
  vec4 sum = upper * (1 - p.f.y) + lower * p.f.y;
  // Coverage is zero where all texels around the hit are hidden, and for rays that landed nowhere.
  if (!(sum.w > 0)) return vec3(0);
  vec3 mean = sum.xyz * (weight_of(hit) / sum.w);
  uint tint = hit.x & kNoTint;
  return tint == kNoTint ? mean : mean * unpack_tint(tint);
}

void add(uvec2 hit, bool is_last_round, inout Gathered g) {
  vec3 b = lookup(hit);
  float l = dot(b, vec3(0.2126, 0.7152, 0.0722));
  g.sum += b, g.sum_luminance2 += l * l;
  g.first_less_second += is_last_round && (hit.x & kSecondHalf) != 0 ? -l : l;
}

void main() {
  uint tile = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x, own = tile * kRaysTogether + lane;
  if (own >= slot_count) return;
  RaySlot slot = slots.at[own];
  uint i = slot.element, count = counted.at[i];
  if (round < (count & 255u)) return;
  bool is_last_round = round == count >> 8;
  Gathered g = Gathered(vec3(0), 0, 0);
  for (uint place = 0; place < slot.places; ++place) {
    uvec2 hit = hits.at[(rows.at[tile] + place) * kRaysTogether + lane];
    if (hit.y != 0 || hit.x >> 15 != 0) add(hit, is_last_round, g);  // else it landed nowhere
  }
  for (uint k = i == 0 ? 0 : ends.at[i - 1]; k < ends.at[i]; ++k) add(more.at[k], is_last_round, g);
  Gathered before = gathered.at[i];
  gathered.at[i] = Gathered(before.sum + g.sum, before.sum_luminance2 + g.sum_luminance2,
                            before.first_less_second + g.first_less_second);
}
