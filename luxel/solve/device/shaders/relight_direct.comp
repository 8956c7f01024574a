// Light of punctual lights that move: a shadow ray per place and light, as matrix::live_light().
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "luxel/light/both_punctual_light.h"
#include "luxel/scene/both_off_surface.h"
layout(local_size_x = 64) in;

const uint kSpot = 1, kDirectional = 2;  // scene::PunctualLight::Kind
// matrix::PatchPoint
struct Place {
  vec3 position, normal;
};
IN_BUFFER(Places, Place);
#include "luxel/solve/device/moved_lights_shared.h"

vec3 light_of(MovedLight l, Place p) {
  vec3 towards = -l.direction;
  float t_max = uintBitsToFloat(0x7f800000u), share = 1;
  if (l.kind != kDirectional) {
    vec3 to_light = l.position - p.position;
    float distance_m = length(to_light);
    if (distance_m <= 0) return vec3(0);
    towards = to_light * (1 / distance_m);
    share = share_at_distance(distance_m, l.range_m);
    if (l.kind == kSpot) share *= share_in_cone(-dot(towards, l.direction), l.cos_inner, l.cos_outer);
    t_max = reach_of_shadow_ray(distance_m, l.position);
  }
  float cosine = dot(p.normal, towards);
  vec3 arriving = l.intensity * (share * cosine);
  if (!(cosine > 0) || !(max(arriving.x, max(arriving.y, arriving.z)) > 0)) return vec3(0);
  return trace(world, Ray(p.position, towards, 0, t_max), true).number == kNoTriangle ? arriving : vec3(0);
}

void main() {
  uint i = (first_group + gl_WorkGroupID.x) * 64 + gl_LocalInvocationID.x;
  if (i >= place_count) return;
  vec3 sum = vec3(0);
  for (uint k = 0; k < light_count; ++k) sum += light_of(lights.at[k], places.at[i]);
  light.at[i] = sum;
}
