// The frame around a normal, where rays start beside a surface, and luminance, as luxel/base/vec.h and
// luxel/scene/off_surface.h have them.
#ifndef FRAME_GLSL
#define FRAME_GLSL
#include "luxel/scene/both_off_surface.h"

// [Duff17]
vec3 to_world(vec3 n, vec3 local) {
  float sign = (floatBitsToUint(n.z) >> 31) != 0 ? -1.0 : 1.0;
  float a = -1 / (sign + n.z), b = n.x * n.y * a;
  vec3 tangent = vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
  vec3 bitangent = vec3(b, sign + n.y * n.y * a, -n.y);
  return tangent * local.x + bitangent * local.y + n * local.z;
}

vec3 off_surface(vec3 position, vec3 normal, float size_m) { return position + normal * rounding_m(position, size_m); }

float luminance(vec3 c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

#endif
