// Double-precision vectors, for exact work where a float's rounding would show.
#pragma once

#include <algorithm>
#include <array>
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

/// An affine map, as Mat34.
struct DMat34 {
  std::array<std::array<double, 4>, 3> row{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  friend bool operator==(const DMat34&, const DMat34&) = default;
};
inline DVec3 transform_point(const DMat34& m, DVec3 p) {
  const auto along = [&](const std::array<double, 4>& r) {
    return r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
  };
  return {along(m.row[0]), along(m.row[1]), along(m.row[2])};
}
inline DMat34 operator*(const DMat34& a, const DMat34& b) {
  DMat34 c;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 4; ++j) {
      c.row[i][j] = j == 3 ? a.row[i][3] : 0.0;
      for (size_t k = 0; k < 3; ++k) c.row[i][j] += a.row[i][k] * b.row[k][j];
    }
  return c;
}
inline DVec3 translation_of(const DMat34& m) { return {m.row[0][3], m.row[1][3], m.row[2][3]}; }
inline DMat34 moved_by(DVec3 t) {
  DMat34 m;
  m.row[0][3] = t.x, m.row[1][3] = t.y, m.row[2][3] = t.z;
  return m;
}
inline DMat34 to_double(const Mat34& m) {
  DMat34 out;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 4; ++j) out.row[i][j] = double(m.row[i][j]);
  return out;
}

/// An axis-aligned box, as Box3.
struct DBox3 {
  DVec3 lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};
  void extend(DVec3 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
};

}  // namespace base
}  // namespace luxel
