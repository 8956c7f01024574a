// Punctual lights that move, and the places that they light. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_MOVED_LIGHTS_SHARED_H
#define LUXEL_SOLVE_DEVICE_MOVED_LIGHTS_SHARED_H
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

struct MovedLight {
  vec3 intensity, position, direction;
  float range_m, cos_inner, cos_outer;
  uint kind;
};
IN_BUFFER(MovedLights, MovedLight);
OUT_BUFFER(LightOfPlaces, vec3);

PUSH(MovedPush) {
  World world;
  REF(MovedLights) lights;
  REF(Places) places;
  REF(LightOfPlaces) light;
  uint place_count, light_count;
  uint first_group;
};

SHARED_END
#endif
