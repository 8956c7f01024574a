// Macros by which one text is C++ and GLSL: formulas that the processor and a graphics device share
// stand once, in files named both_*.h. In C++ they lie in luxel::both. The rules of such a text:
// functions begin with BOTH. Types are uint, int, float, double, vec2 and vec3, made by vec2_of()
// and vec3_of(). DOUBLE(x) is a number in double precision, and INOUT(type) a parameter that the
// function changes. unit_or_zero() stands for normalize(), because GLSL's has no answer for the
// zero vector.
#ifndef LUXEL_BASE_BOTH_LANGUAGE_H
#define LUXEL_BASE_BOTH_LANGUAGE_H

#ifdef VULKAN  // as GLSL has it
#define BOTH
#define BOTH_BEGIN
#define BOTH_END
#define INOUT(type) inout type
// glslang keeps all digits of a number that it converts, and has no suffix that C++ has, too.
#define DOUBLE(x) double(x)
#define vec2_of vec2
#define vec3_of vec3
vec3 unit_or_zero(vec3 v) {
  float l = length(v);
  return l > 0 ? v * (1 / l) : vec3(0);
}
#else
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "luxel/base/vec.h"

#define BOTH inline
#define BOTH_BEGIN        \
  namespace luxel::both { \
  using uint = uint32_t;  \
  using vec2 = Vec2;      \
  using vec3 = Vec3;      \
  using std::abs;         \
  using std::clamp;       \
  using std::floor;       \
  using std::max;         \
  using std::min;         \
  using std::sqrt;
#define BOTH_END }
#define INOUT(type) type&
#define DOUBLE(x) double(x)

namespace luxel::both {
inline Vec2 vec2_of(float x, float y) { return {x, y}; }
inline Vec3 vec3_of(float x, float y, float z) { return {x, y, z}; }
inline Vec3 unit_or_zero(Vec3 v) { return normalize(v); }
}  // namespace luxel::both
#endif

#endif
