#extension GL_GOOGLE_include_directive : require
#include "luxel/gpu/shared_language.h"

// view::ShapeCorner
struct Corner {
  vec3 place;
  vec3 color;
  float opacity;
};
IN_BUFFER(ShapeCorners, Corner);
#include "luxel/view/draw/shape_shared.h"
