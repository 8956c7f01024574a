// The push constants of what stands behind all surfaces. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_BEHIND_SHARED_H
#define LUXEL_VIEW_DRAW_BEHIND_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

PUSH(BehindPush) {
  vec3 forward, right, up;  // of the picture's middle, and to its edges
  vec3 background;
  vec3 map_scale;  // 0: there is no map
  float rotation;
  float exposure;
  uint show;
};

SHARED_END
#endif
