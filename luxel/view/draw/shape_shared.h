// The push constants of shapes. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_SHAPE_SHARED_H
#define LUXEL_VIEW_DRAW_SHAPE_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

const uint kTriangleShapes = 0, kLineShapes = 1, kDiscShapes = 2;

PUSH(ShapePush) {
  mat4 clip_from_world;
  REF(ShapeCorners) corners;
  vec2 picture;  // its size [pixels]
  float width;   // of lines and discs [pixels]
  float nearer, nearer_parallel;
  uint kind;
  uint curve;  // display::ToneMap
};

SHARED_END
#endif
