// Falloff of the light of points, spots and suns. [KHR_lights_punctual] C++ and GLSL.
#ifndef LUXEL_LIGHT_BOTH_PUNCTUAL_LIGHT_H
#define LUXEL_LIGHT_BOTH_PUNCTUAL_LIGHT_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// Up to so many punctual lights each one gets its shadow ray; of more, so many are drawn.
const uint kMaxAllPunctual = 64;

// 1 / d^2 times the window of the range, 0: none.
BOTH float share_at_distance(float distance_m, float range_m) {
  float share = 1 / (distance_m * distance_m);
  if (range_m > 0) {
    const float q = distance_m / range_m;
    share *= clamp(1 - q * q * q * q, 0.0f, 1.0f);
  }
  return share;
}

// The ramp between the inner and the outer cone of a spot; `cosine` is that of the angle to its
// direction.
BOTH float share_in_cone(float cosine, float cos_inner, float cos_outer) {
  const float t = clamp((cosine - cos_outer) / max(1e-3f, cos_inner - cos_outer), 0.0f, 1.0f);
  return t * t;
}

// A direction of a sun's disc, about +z: uniform over a cone. `height` is 1 - cos(its angle), and
// `circle` the point of the unit circle for 2 pi u.x.
BOTH vec3 direction_in_disc(float height, vec2 u, vec2 circle) {
  const float down = u.y * height, radius = sqrt(max(0.0f, down * (2 - down)));
  return vec3_of(radius * circle.x, radius * circle.y, 1 - down);
}

BOTH_END
#endif
