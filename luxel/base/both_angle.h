// The angle of a point of the plane without branches and calls. C++ and GLSL.
#ifndef LUXEL_BASE_BOTH_ANGLE_H
#define LUXEL_BASE_BOTH_ANGLE_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// atan2(y, x), to 4e-7, where zeros have no sign; 0 for (0, 0). By the arc tangent of [0, 1]
// [Abramowitz64, 4.4.49].
BOTH float angle_of(float y, float x) {
  const float pi = 3.14159265358979323846f;
  const float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
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
  angle = ay > ax ? 0.5f * pi - angle : angle;
  angle = x < 0 ? pi - angle : angle;
  return y < 0 ? -angle : angle;
}

BOTH_END
#endif
