// Points of the circle and their angles, for the middle of loops: without branches and calls, so
// that compilers make vector code of them, which the standard library's functions prevent.
#pragma once

#include <cmath>

#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

/// cos and sin of 2 pi x for x in [0, 1), to 4e-7: each quarter turn by Taylor's series about its
/// middle, of which (pi/4)^9 / 9! = 3.1e-7 is left out, and rounding.
inline Vec2 unit_circle(float x) {
  const float turns = 4 * x;
  const int quadrant = int(turns);
  const float t = (turns - float(quadrant) - 0.5f) * (0.5f * kPi);  // [-pi/4, pi/4)
  const float t2 = t * t;
  const float s = t * (1 + t2 * (-1.0f / 6 + t2 * (1.0f / 120 + t2 * (-1.0f / 5040))));
  const float c = 1 + t2 * (-0.5f + t2 * (1.0f / 24 + t2 * (-1.0f / 720 + t2 * (1.0f / 40320))));
  const float h = 0.70710678f;
  const float cosine = h * (c - s), sine = h * (c + s);  // turned by the missing eighth
  const float a = (quadrant & 1) ? -sine : cosine, b = (quadrant & 1) ? cosine : sine;
  const float sign = (quadrant & 2) ? -1.0f : 1.0f;
  return {a * sign, b * sign};
}

/// atan2(y, x), to 4e-7, where zeros have no sign; 0 for (0, 0). By the arc tangent of [0, 1]
/// [Abramowitz64, 4.4.49].
inline float angle_of(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float larger = ax > ay ? ax : ay, smaller = ax > ay ? ay : ax;
  const float z = smaller / (larger > 0 ? larger : 1), z2 = z * z;
  float angle =
      z * (1 + z2 * (-.3333314528f +
                     z2 * (.1999355085f +
                           z2 * (-.1420889944f +
                                 z2 * (.1065626393f +
                                       z2 * (-.0752896400f +
                                             z2 * (.0429096138f +
                                                   z2 * (-.0161657367f + z2 * .0028662257f))))))));
  angle = ay > ax ? 0.5f * kPi - angle : angle;
  angle = x < 0 ? kPi - angle : angle;
  return y < 0 ? -angle : angle;
}

}  // namespace base
}  // namespace luxel
