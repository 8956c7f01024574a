// What elements gather from the map at the places where their rays have landed. A thread takes an
// element. luxel/solve/gather/bounce/sweep.h, ../device_sweep.h
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stored_hits.glsl"
layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Map { vec4 at[]; };
layout(buffer_reference, scalar) readonly buffer Ends { uint at[]; };
// gather::Gathered
struct Gathered {
  vec3 sum;
  float sum_luminance2, first_less_second;
};
layout(buffer_reference, scalar) writeonly buffer AllGathered { Gathered at[]; };

layout(push_constant, scalar) uniform Push {
  Map map;  // gather::RadiosityMap
  StoredHits hits;  // of the chunk
  StoredHits more;  // of all elements, one element's after another's
  Ends ends;        // per element, one past the last of `more`
  AllGathered gathered;
  uint element_count, samples;
  uint map_stride;
  uint first_tile;  // of the chunk
  uint first_group;
};

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

void add(uvec2 hit, inout Gathered g) {
  vec3 b = lookup(hit);
  float l = dot(b, vec3(0.2126, 0.7152, 0.0722));
  g.sum += b, g.sum_luminance2 += l * l;
  g.first_less_second += (hit.x & kSecondHalf) != 0 ? -l : l;
}

void main() {
  uint tile = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x, i = (first_tile + tile) * 64 + lane;
  if (i >= element_count) return;
  Gathered g = Gathered(vec3(0), 0, 0);
  for (uint place = 0; place < samples; ++place) {
    uvec2 hit = hits.at[(tile * samples + place) * 64 + lane];
    if (hit.y != 0 || hit.x >> 15 != 0) add(hit, g);  // else it landed nowhere
  }
  for (uint k = i == 0 ? 0 : ends.at[i - 1]; k < ends.at[i]; ++k) add(more.at[k], g);
  gathered.at[i] = g;
}
