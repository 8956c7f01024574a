// The push constants of shadow maps, and of the masks of outlines. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_SHADOW_SHARED_H
#define LUXEL_VIEW_DRAW_SHADOW_SHARED_H
#include "luxel/view/draw/scene_shared.h"
SHARED_BEGIN

PUSH(ShadowPush) {
  mat4 clip_from_world;
  REF(Vertices) vertices;
  REF(Materials) materials;
  REF(Instances) instances;
  uint instance, material;
};

SHARED_END
#endif
