// The soft light around a scene: light::soft_radiance().
#extension GL_GOOGLE_include_directive : require
#include "luxel/scene/both_environment.h"
#include "luxel/solve/device/surroundings_shared.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

vec3 soft_radiance(Surroundings around, vec3 direction) {
  if (around.width == 0) return around.background;
  vec3 l = around.pixels.at[pixel_of_environment(
      around.width, around.height, place_in_environment(around.rotation_rad, direction))];
  float over = luminance(l);
  return around.background + l * (over > around.limit ? around.limit / over : 1.0);
}
