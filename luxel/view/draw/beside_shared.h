// The push constants of two pictures of one view. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_BESIDE_SHARED_H
#define LUXEL_VIEW_DRAW_BESIDE_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

IN_BUFFER(FalseColors, uint);  // 256, 0xbbggrr

PUSH(BesidePush) {
  REF(FalseColors) colors;
  uint mode;      // view::BesideMode
  float line_at;  // in pixels from the left
  float highest;  // relative difference with the last colour
};

SHARED_END
#endif
