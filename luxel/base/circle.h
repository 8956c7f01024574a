// Points of the circle and their angles, for the middle of loops: without branches and calls, so
// that compilers make vector code of them, which the standard library's functions prevent.
#pragma once

#include <cmath>

#include "luxel/base/both_circle.h"
#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

/// cos and sin of 2 pi x for x in [0, 1), to 4e-7.
using both::unit_circle;

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
