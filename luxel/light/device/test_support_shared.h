// Inputs of formulas, and what they give: formulas_test.cpp. C++ and GLSL.
#ifndef LUXEL_LIGHT_DEVICE_TEST_SUPPORT_SHARED_H
#define LUXEL_LIGHT_DEVICE_TEST_SUPPORT_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

struct Question {
  vec3 a, b, c, light_normal;
  vec3 position, normal, geometric_normal, direction;
  vec2 u;
  float angle, distance_m;
};
IN_BUFFER(Questions, Question);

struct Answer {
  vec3 by_angle, by_area, column;
  vec2 at, angle;
  float irradiance, weight_by_angle, measure_by_angle, weight_by_area;
  float importance, at_distance, in_cone, folded, arc_tangent;
  vec3 in_disc;
  double factor;
};
OUT_BUFFER(Answers, Answer);

PUSH(FormulaPush) {
  REF(Questions) questions;
  REF(Answers) answers;
  uint count;
};

SHARED_END
#endif
