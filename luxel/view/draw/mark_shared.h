// The push constants of marks: luxel/view/mark.h. Places are pixels. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_MARK_SHARED_H
#define LUXEL_VIEW_DRAW_MARK_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

PUSH(MarkPush) {
  vec2 from, to;
  vec2 picture;  // its size
  float radius, edge_width;
  vec3 color, edge;
};

SHARED_END
#endif
