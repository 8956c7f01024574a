// Triangles whose light is quadratic. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_QUADRATIC_SHARED_H
#define LUXEL_VIEW_DRAW_QUADRATIC_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

struct QuadraticTriangle {
  ARRAY(vec3, 3) corner;
  // E = ((A s + 2B t) + 2C) s + (D t + 2E) t + F, s and t the weights of the second and third
  // corner
  ARRAY(vec3, 6) irradiance;
  vec3 reflectance, emission;
  uint group, two_sided;
};
IN_BUFFER(QuadraticTriangles, QuadraticTriangle);
IN_BUFFER(Exact, vec4);

PUSH(QuadraticPush) {
  mat4 clip_from_world;
  REF(QuadraticTriangles) triangles;
  REF(Exact) exact;
  uint exact_width;  // 0: there are no exact pixels
  float exposure;
  uint show;
};

SHARED_END
#endif
