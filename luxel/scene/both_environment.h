// Where a direction looks in an equirectangular map: scene::Environment says how it lies. C++ and
// GLSL.
#ifndef LUXEL_SCENE_BOTH_ENVIRONMENT_H
#define LUXEL_SCENE_BOTH_ENVIRONMENT_H
#include "luxel/base/both_angle.h"
BOTH_BEGIN

// The place of a unit direction, in [0, 1) x [0, 1]. By angle_of(), because the arc cosine loses
// half of the digits near the poles.
BOTH vec2 place_in_environment(float rotation_rad, vec3 d) {
  const float pi = 3.14159265358979323846f;
  const float u = 0.5f + (angle_of(d.z, d.x) - rotation_rad) * (1 / (2 * pi));
  const float wrapped = u - floor(u);
  return vec2_of(wrapped < 1 ? wrapped : 0.0f,
                 angle_of(sqrt(d.x * d.x + d.z * d.z), d.y) * (1 / pi));
}

// The pixel of a place.
BOTH uint pixel_of_environment(int width, int height, vec2 place) {
  const int x = int(place.x * float(width)), y = int(place.y * float(height));
  const int column = x < width ? x : width - 1;
  const int row = y < 0 ? 0 : y < height ? y : height - 1;  // NaN is anything
  return uint(row) * uint(width) + uint(column);
}

BOTH_END
#endif
