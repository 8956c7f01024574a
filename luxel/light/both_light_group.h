// Estimate of the light that a group of lights may bring to a point. C++ and GLSL.
#ifndef LUXEL_LIGHT_BOTH_LIGHT_GROUP_H
#define LUXEL_LIGHT_BOTH_LIGHT_GROUP_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// Groups among which light is shared out by their importance, at most.
const uint kMaxCut = 16;

// Members of light::LightNode, which says what they mean.
struct LightGroup {
  vec3 centre;
  float radius_m, power;
  vec3 facing;
  float even;
  vec3 axis;
  float cos_angle, sin_angle, reach_m;
};

// True where no light of the group leaves towards the point. All cones with their apex in the
// sphere lie in the cone of the same angle whose apex lies radius / sin(angle) behind the centre.
BOTH bool outside_cone(LightGroup group, vec3 from_centre) {
  if (group.sin_angle <= 0) return false;
  const vec3 from_apex = from_centre + group.axis * (group.radius_m / group.sin_angle);
  return dot(from_apex, group.axis) < group.cos_angle * length(from_apex);
}

// Luminance of the irradiance from the group, nothing in between: an estimate that is zero only
// where nothing can arrive. power * cos * (even + cos') / d^2, with each cosine taken a tenth of a
// radius to the bright side and never below a twentieth, and the distance never below half the
// radius: what keeps rays for lights on the far side of the centre. More than a tenth is noise
// where lights lie around the place at all distances: in a sphere, twice as much with a quarter.
BOTH float importance_of(LightGroup group, vec3 position, vec3 normal) {
  const float least = 0.05f, to_bright_side = 0.1f;
  const vec3 to = group.centre - position;
  const float r = group.radius_m, height = dot(to, normal), d2 = dot(to, to);
  if (height < -r) return 0;
  const float d = sqrt(d2);
  if (d - r > group.reach_m || outside_cone(group, -to)) return 0;
  const float inverse = 1 / max(max(d, 0.5f * r), 1e-18f);
  const float cosine = clamp((height + to_bright_side * r) * inverse, least, 1.0f);
  const float facing = max(least, (to_bright_side * r - dot(to, group.facing)) * inverse);
  return group.power * cosine * (group.even + min(1.0f, facing)) * inverse * inverse;
}

BOTH_END
#endif
