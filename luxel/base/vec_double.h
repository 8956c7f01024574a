// Double-precision vectors, for exact work where a float's rounding would show.
#pragma once

#include <cmath>

#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

inline constexpr double kPiDouble = 3.14159265358979323846;

struct DVec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const DVec3&, const DVec3&) = default;
};

inline DVec3 operator+(DVec3 a, DVec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline DVec3 operator-(DVec3 a, DVec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline DVec3 operator-(DVec3 a) { return {-a.x, -a.y, -a.z}; }
inline DVec3 operator*(DVec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline DVec3 operator*(double s, DVec3 a) { return a * s; }
inline DVec3& operator+=(DVec3& a, DVec3 b) { return a = a + b; }
inline double dot(DVec3 a, DVec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline DVec3 cross(DVec3 a, DVec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(DVec3 a) { return std::sqrt(dot(a, a)); }
/// The unit vector along a; the zero vector stays zero.
inline DVec3 normalize(DVec3 a) {
  const double l = length(a);
  return l > 0 ? a * (1.0 / l) : DVec3{};
}
inline DVec3 to_double(Vec3 a) { return {a.x, a.y, a.z}; }
inline Vec3 to_float(DVec3 a) { return {float(a.x), float(a.y), float(a.z)}; }

}  // namespace base
}  // namespace luxel
