// Light of places as the picture that shaders look up, step by step.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/gpu/shared_language.h"

BLOCK(Number) { uint value; };
layout(buffer_reference, scalar) writeonly buffer Scale { float value; };
#include "luxel/view/relight/relit_map_shared.h"

layout(local_size_x = kMapThreads) in;
layout(constant_id = 0) const uint kStep = 0;

vec3 light_of_place(uint place) {
  vec3 e = map.light.at[place];
  return mix(e, vec3(0), bvec3(isnan(e.x) || isinf(e.x), isnan(e.y) || isinf(e.y), isnan(e.z) || isinf(e.z)));
}

vec3 mean_around(uint k) {
  vec3 sum = vec3(0);
  uint first = map.first.at[k], end = map.first.at[k + 1];
  for (uint i = first; i < end; ++i) sum += map.pixels.at[map.from.at[i]];
  return sum / float(end - first);
}

// image::to_half(): the largest value lies in [2^14, 2^15) then.
float scale_now() {
  uint largest = map.largest.value;
  if (largest == 0) return 1;
  int exponent = int(largest >> 23) - 126;
  return uintBitsToFloat(uint(clamp(exponent - 15, -100, 127) + 127) << 23);
}

void main() {
  uint k = begin + gl_GlobalInvocationID.x;
  if (k >= end) return;
  if (kStep == kMapPlaces) {
    map.pixels.at[map.pixel.at[k]] = light_of_place(map.place.at[k]);
  } else if (kStep == kMapGutter) {
    map.pixels.at[map.gutter.at[k]] = mean_around(k);
  } else if (kStep == kMapLargest) {
    vec3 e = abs(map.pixels.at[k]);
    float largest = max(e.x, max(e.y, e.z));
    if (largest > 0) atomicMax(map.largest.value, floatBitsToUint(largest));  // such bits are in order
  } else {
    float scale = scale_now();
    vec3 e = min(map.pixels.at[k] / scale, vec3(65504));  // the largest half
    map.halves.at[k] = uvec2(packHalf2x16(e.xy), packHalf2x16(vec2(e.z, 0)));
    if (k == 0) map.scale.value = scale;
  }
}
