// What lets one text be C++ and GLSL: formulas that the processor and a graphics device share stand
// once, in files named both_*.h. In C++ they lie in luxel::both. The rules of such a text:
// functions begin with BOTH, types are uint, int, float, vec2 and vec3, made by vec2_of() and
// vec3_of().
#ifndef LUXEL_BASE_BOTH_LANGUAGE_H
#define LUXEL_BASE_BOTH_LANGUAGE_H

#ifdef VULKAN  // as GLSL has it
#define BOTH
#define BOTH_BEGIN
#define BOTH_END
#define vec2_of vec2
#define vec3_of vec3
#else
#include <cmath>
#include <cstdint>

#include "luxel/base/vec.h"

#define BOTH inline
#define BOTH_BEGIN        \
  namespace luxel::both { \
  using uint = uint32_t;  \
  using vec2 = Vec2;      \
  using vec3 = Vec3;      \
  using std::sqrt;
#define BOTH_END }

namespace luxel::both {
inline Vec2 vec2_of(float x, float y) { return {x, y}; }
inline Vec3 vec3_of(float x, float y, float z) { return {x, y, z}; }
}  // namespace luxel::both
#endif

#endif
