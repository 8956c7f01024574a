// Light of places as the picture that shaders look up, step by step. ../relight/relit_on_device.cpp
// has the structs.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;

layout(constant_id = 0) const uint kStep = 0;
const uint kPlaces = 0, kGutter = 1, kLargest = 2, kHalves = 3;

layout(buffer_reference, scalar) readonly buffer Light { vec3 at[]; };
layout(buffer_reference, scalar) readonly buffer Numbers { uint at[]; };
layout(buffer_reference, scalar) buffer Pixels { vec3 at[]; };
layout(buffer_reference, scalar) buffer Halves { uvec2 at[]; };
layout(buffer_reference, scalar) buffer Number { uint value; };
layout(buffer_reference, scalar) writeonly buffer Scale { float value; };

// view::MapPlaces, and what becomes of them.
layout(buffer_reference, scalar) buffer Map {
  Light light;
  Numbers place, pixel;
  Numbers gutter, first, from;
  Pixels pixels;   // E
  Number largest;  // the bits of a float
  Halves halves;
  Scale scale;     // E = scale * half
  uint pixel_count;
};
layout(push_constant, scalar) uniform Push {
  Map map;
  uint begin, end;  // places, pixels of the gutter, or pixels
};

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
  if (kStep == kPlaces) {
    map.pixels.at[map.pixel.at[k]] = light_of_place(map.place.at[k]);
  } else if (kStep == kGutter) {
    map.pixels.at[map.gutter.at[k]] = mean_around(k);
  } else if (kStep == kLargest) {
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
