// The distances from surfaces at which rays start and end. C++ and GLSL.
#ifndef LUXEL_SCENE_BOTH_OFF_SURFACE_H
#define LUXEL_SCENE_BOTH_OFF_SURFACE_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// The distance by which rounding may put a point off its surface [m].
BOTH float rounding_m(vec3 position, float size_m) {
  // Interpolating three corners, moving them into the world and adding this errs by up to 2.6
  // roundings (2^-24) of the numbers involved, and intersecting triangles by as many. Of the
  // 345,600 rays of OffSurface.LeavesItsQuad, each by three tracers, those that meet their own
  // plane are 1188 with 2^-23, 328 with 2^-22, and none with 2^-21 to 2^-18; of 6.8 million from
  // quads of random sizes, turns and places 8 meet their own with 2^-22, none with 2^-21.5 to
  // 2^-20. No larger than that: 2 km from the origin 2^-20 gives a room of 1 m 0.55 % more light,
  // 2^-21 half of that. [Waechter19]
  const float part = 4.76837158203125e-7f;  // 2^-21
  return part * max(max(abs(position.x), max(abs(position.y), abs(position.z))), size_m);
}

// The length of a shadow ray to a lamp [m]: it ends a little before it, so that a surface that the
// lamp lies in, or a hair behind, does not hide it.
BOTH float reach_of_shadow_ray(float distance_m, vec3 lamp) {
  return max(0.0f, distance_m - max(1e-4f * distance_m, 4 * rounding_m(lamp, 0)));
}

BOTH_END
#endif
