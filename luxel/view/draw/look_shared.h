// A look into a bake. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_LOOK_SHARED_H
#define LUXEL_VIEW_DRAW_LOOK_SHARED_H
#include "luxel/view/draw/scene_shared.h"
SHARED_BEGIN

IN_BUFFER(Corners, uint);
// Per triangle: its chart, times eight, and a bit for each edge that is a seam.
IN_BUFFER(Charts, uint);

IN_BLOCK(Look) {
  REF(Corners) corners;
  REF(Charts) charts;
  REF(LightNow) light_now;
  float second_light;  // its share
  uint show, channel;
  float low, high;
  uint is_logarithmic;
  float exposure;
  vec3 forward;
  ARRAY(uint, 256) colors;  // false ones, 0xbbggrr
};

SHARED_END
#endif
