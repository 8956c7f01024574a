// Angles, and the points of the circle that they stand for. C++ and GLSL.
#ifndef LUXEL_BASE_BOTH_ANGLE_H
#define LUXEL_BASE_BOTH_ANGLE_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// atan2(y, x) without branches and calls, to 4e-7, where zeros have no sign; 0 for (0, 0). By the
// arc tangent of [0, 1] [Abramowitz64, 4.4.49].
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

// arc_tangent() and cos_and_sin() are the standard library's on the processor. Vulkan lets those of
// GLSL err by 2^-11, so that a device has its own.
#ifdef VULKAN
// atan2(y, x), to 4e-7.
float arc_tangent(float y, float x) { return angle_of(y, x); }

// cos and sin of an angle of at most 2 pi, to 2e-7: by Taylor's series about the nearest quarter
// turn, of which (pi/4)^10 / 10! = 2.5e-8 is left out, and rounding.
vec2 cos_and_sin(float angle) {
  float quarters = floor(angle * 0.63661977236758134308 + 0.5);
  // The quarter turn is the sum of two floats: the first one is too large by the second.
  float t = (angle - quarters * 1.57079637050628662109) + quarters * 4.37113900018624e-8;
  float t2 = t * t;
  float s = t * (1 + t2 * (-1.0 / 6 + t2 * (1.0 / 120 + t2 * (-1.0 / 5040 + t2 * (1.0 / 362880)))));
  float c = 1 + t2 * (-0.5 + t2 * (1.0 / 24 + t2 * (-1.0 / 720 + t2 * (1.0 / 40320))));
  int quadrant = int(quarters) & 3;
  vec2 turned = (quadrant & 1) != 0 ? vec2(-s, c) : vec2(c, s);
  return (quadrant & 2) != 0 ? -turned : turned;
}
#else
inline float arc_tangent(float y, float x) { return std::atan2(y, x); }
inline vec2 cos_and_sin(float angle) { return {std::cos(angle), std::sin(angle)}; }
#endif

BOTH_END
#endif
