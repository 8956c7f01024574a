// Points of the circle without branches and calls. C++ and GLSL.
#ifndef LUXEL_BASE_BOTH_CIRCLE_H
#define LUXEL_BASE_BOTH_CIRCLE_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// cos and sin of 2 pi x for x in [0, 1), to 4e-7: each quarter turn by Taylor's series about its
// middle, of which (pi/4)^9 / 9! = 3.1e-7 is left out, and rounding.
BOTH vec2 unit_circle(float x) {
  const float turns = 4 * x;
  const int quadrant = int(turns);
  const float t = (turns - float(quadrant) - 0.5f) * 1.57079632679489661923f;  // [-pi/4, pi/4)
  const float t2 = t * t;
  const float s = t * (1 + t2 * (-1.0f / 6 + t2 * (1.0f / 120 + t2 * (-1.0f / 5040))));
  const float c = 1 + t2 * (-0.5f + t2 * (1.0f / 24 + t2 * (-1.0f / 720 + t2 * (1.0f / 40320))));
  const float h = 0.70710678f;
  const float cosine = h * (c - s), sine = h * (c + s);  // turned by the missing eighth
  const float a = (quadrant & 1) != 0 ? -sine : cosine, b = (quadrant & 1) != 0 ? cosine : sine;
  const float sign = (quadrant & 2) != 0 ? -1.0f : 1.0f;
  return vec2_of(a * sign, b * sign);
}

BOTH_END
#endif
