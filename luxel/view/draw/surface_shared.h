// The push constants by which surfaces are drawn. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_SURFACE_SHARED_H
#define LUXEL_VIEW_DRAW_SURFACE_SHARED_H
#include "luxel/view/draw/scene_shared.h"
SHARED_BEGIN

PUSH(SurfacePush) {
  mat4 clip_from_world;
  REF(Vertices) vertices;
  REF(Materials) materials;
  REF(Instances) instances;
  REF(LightNow) light_now;
  uint instance, material;
  float exposure;
  uint show;
  float second_light;  // its share
};

SHARED_END
#endif
