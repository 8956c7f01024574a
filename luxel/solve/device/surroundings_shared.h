// The soft light around a scene: light::Surroundings. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_SURROUNDINGS_SHARED_H
#define LUXEL_SOLVE_DEVICE_SURROUNDINGS_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

IN_BUFFER(MapPixels, vec3);

IN_BLOCK(Surroundings) {
  vec3 background;
  float limit;        // of a pixel's luminance: what is above is aimed at
  int width, height;  // 0: no map
  float rotation_rad;
  REF(MapPixels) pixels;
};

SHARED_END
#endif
