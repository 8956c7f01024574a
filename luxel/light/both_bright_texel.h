// Directions within a pixel of an equirectangular map. C++ and GLSL.
#ifndef LUXEL_LIGHT_BOTH_BRIGHT_TEXEL_H
#define LUXEL_LIGHT_BOTH_BRIGHT_TEXEL_H
#include "luxel/base/both_circle.h"
BOTH_BEGIN

// The direction whose cosine to up is `up`, at a part `within` of the width of the pixels in column
// `column`.
BOTH vec3 direction_in_column(int width, float rotation_rad, int column, float within, double up) {
  const float pi = 3.14159265358979323846f;
  const double sine = sqrt(max(DOUBLE(0), (1 - up) * (1 + up)));
  const float turns =
      (float(column) + within) / float(width) - 0.5f + rotation_rad * (1 / (2 * pi));
  const float wrapped = turns - floor(turns);
  const vec2 around = unit_circle(wrapped < 1 ? wrapped : 0.0f);
  return vec3_of(float(sine) * around.x, float(up), float(sine) * around.y);
}

BOTH_END
#endif
