// The push constants by which a bake is looked into. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_OVERLAY_SHARED_H
#define LUXEL_VIEW_DRAW_OVERLAY_SHARED_H
#include "luxel/view/draw/look_shared.h"
SHARED_BEGIN

PUSH(OverlayPush) {
  mat4 clip_from_world;
  REF(Vertices) vertices;
  REF(Materials) materials;
  REF(Instances) instances;
  REF(Look) look;
  uint instance, material;
  uint culled;  // faces that are left out: 0 none, 1 the back ones, 2 the front ones
};

SHARED_END
#endif
