// The soft light around a scene: light::Surroundings, light::soft_radiance().
#extension GL_GOOGLE_include_directive : require
#include "luxel/scene/both_environment.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

layout(buffer_reference, scalar) readonly buffer MapPixels { vec3 at[]; };
layout(buffer_reference, scalar) readonly buffer Surroundings {
  vec3 background;
  float limit;  // of a pixel's luminance: what is above is aimed at
  int width, height;  // 0: no map
  float rotation_rad;
  uint unused;
  MapPixels pixels;
};

vec3 soft_radiance(Surroundings around, vec3 direction) {
  if (around.width == 0) return around.background;
  vec3 l = around.pixels.at[pixel_of_environment(
      around.width, around.height, place_in_environment(around.rotation_rad, direction))];
  float over = luminance(l);
  return around.background + l * (over > around.limit ? around.limit / over : 1.0);
}
