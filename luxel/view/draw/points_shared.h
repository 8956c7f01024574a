// Light straight from lamps at points. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_POINTS_SHARED_H
#define LUXEL_VIEW_DRAW_POINTS_SHARED_H
#include "luxel/view/draw/scene_shared.h"
SHARED_BEGIN

// A work group has so many points.
const uint kPointThreads = 64;

// A place of a surface [m], and the side that is lit.
struct LitPoint {
  vec3 position, normal;
};
IN_BUFFER(LitPoints, LitPoint);
OUT_BUFFER(LightOfPoints, vec3);

PUSH(PointsPush) {
  REF(LightNow) light_now;
  REF(LitPoints) points;
  REF(LightOfPoints) irradiance;
  uint count;
};

SHARED_END
#endif
