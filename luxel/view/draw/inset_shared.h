// The push constants of insets. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_INSET_SHARED_H
#define LUXEL_VIEW_DRAW_INSET_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

IN_BUFFER(InsetPixels, uint);  // 0xaabbggrr

PUSH(InsetPush) {
  REF(InsetPixels) pixels;
  uvec2 corner;  // of the picture [pixels]
  uvec2 size;
  vec2 picture;  // its size
};

SHARED_END
#endif
