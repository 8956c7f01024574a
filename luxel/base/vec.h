// Small vector mathematics: plain structs of floats, value in, value out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace luxel {
inline namespace base {

inline constexpr float kPi = 3.14159265358979323846f;

/// Two floats: a place in UV space, in texels or in a plane.
struct Vec2 {
  float x = 0, y = 0;
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

/// Three floats: a position [m], a direction or a colour.
struct Vec3 {
  float x = 0, y = 0, z = 0;
  float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
inline Vec2 operator*(float s, Vec2 a) { return a * s; }
/// Scalar product.
inline float dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
/// Twice the signed area of the triangle (0, a, b); positive when b lies to the left of a.
inline float cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
/// Euclidean length.
inline float length(Vec2 a) { return std::sqrt(dot(a, a)); }

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(float s, Vec3 a) { return a * s; }
inline Vec3 operator/(Vec3 a, float s) { return a * (1.0f / s); }
inline Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
inline Vec3& operator*=(Vec3& a, float s) { return a = a * s; }
/// Scalar product.
inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/// Vector product, right-handed: x cross y is z.
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Euclidean length.
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// The unit vector along a; the zero vector stays zero.
inline Vec3 normalize(Vec3 a) {
  const float l = length(a);
  return l > 0 ? a * (1.0f / l) : Vec3{};
}
/// The smaller value per component.
inline Vec3 min(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
/// The larger value per component.
inline Vec3 max(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
/// The largest component.
inline float max_component(Vec3 a) { return std::max(a.x, std::max(a.y, a.z)); }
/// The smallest component.
inline float min_component(Vec3 a) { return std::min(a.x, std::min(a.y, a.z)); }
/// False when a component is NaN or infinite.
inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Linear light with sRGB primaries; the unit is that of the quantity it carries.
using Rgb = Vec3;
/// Rec. 709 luminance of linear RGB.
inline float luminance(Rgb c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// Barycentric coordinates of corners 1 and 2 of a triangle; corner 0 has the rest.
struct Barycentric {
  float u = 0, v = 0;
};
/// The value at a point of a triangle whose corners have a, b and c, linear between them.
template <class T>
T interpolate(const T& a, const T& b, const T& c, Barycentric at) {
  return a * (1.0f - at.u - at.v) + b * at.u + c * at.v;
}

/// A right-handed orthonormal frame around a unit normal. [Duff17]
struct Frame {
  Vec3 tangent, bitangent, normal;
  /// The vector whose coordinates in this frame are `local`.
  Vec3 to_world(Vec3 local) const {
    return tangent * local.x + bitangent * local.y + normal * local.z;
  }
};
/// A frame whose third axis is the unit vector n. [Duff17]
inline Frame frame_around(Vec3 n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// An affine map: three rows of (linear part, translation).
struct Mat34 {
  std::array<std::array<float, 4>, 3> row{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  friend bool operator==(const Mat34&, const Mat34&) = default;
};
/// A difference of points after the map: without its translation.
inline Vec3 transform_vector(const Mat34& m, Vec3 v) {
  const auto& r = m.row;
  return {r[0][0] * v.x + r[0][1] * v.y + r[0][2] * v.z,
          r[1][0] * v.x + r[1][1] * v.y + r[1][2] * v.z,
          r[2][0] * v.x + r[2][1] * v.y + r[2][2] * v.z};
}
/// A point after the map.
inline Vec3 transform_point(const Mat34& m, Vec3 p) {
  return transform_vector(m, p) + Vec3{m.row[0][3], m.row[1][3], m.row[2][3]};
}
inline Mat34 operator*(const Mat34& a, const Mat34& b) {
  Mat34 c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      float s = j == 3 ? a.row[i][3] : 0.0f;
      for (int k = 0; k < 3; ++k) s += a.row[i][k] * b.row[k][j];
      c.row[i][j] = s;
    }
  return c;
}
/// Column j of the matrix: 0 to 2 where the axes go, 3 the translation.
inline Vec3 column(const Mat34& m, int j) { return {m.row[0][j], m.row[1][j], m.row[2][j]}; }
/// Determinant of the linear part; negative for a mirroring map.
inline float determinant(const Mat34& m) {
  return dot(column(m, 0), cross(column(m, 1), column(m, 2)));
}
/// A normal's direction after the map: the cofactor matrix times n. The result is not of unit
/// length, and it points to the same side of the mapped surface even when the map mirrors.
inline Vec3 transform_normal(const Mat34& m, Vec3 n) {
  const Vec3 a = column(m, 0), b = column(m, 1), c = column(m, 2);
  const Vec3 v = cross(b, c) * n.x + cross(c, a) * n.y + cross(a, b) * n.z;
  return determinant(m) < 0 ? -v : v;
}
/// The map that moves by t.
inline Mat34 translation(Vec3 t) {
  Mat34 m;
  m.row[0][3] = t.x, m.row[1][3] = t.y, m.row[2][3] = t.z;
  return m;
}
/// The map that scales along the axes by the components of s.
inline Mat34 scaling(Vec3 s) {
  Mat34 m;
  m.row[0][0] = s.x, m.row[1][1] = s.y, m.row[2][2] = s.z;
  return m;
}
/// The map whose linear part has these columns, moved by t.
inline Mat34 from_columns(Vec3 x, Vec3 y, Vec3 z, Vec3 t) {
  return {{{{x.x, y.x, z.x, t.x}, {x.y, y.y, z.y, t.y}, {x.z, y.z, z.z, t.z}}}};
}

/// An axis-aligned box; empty when lower > upper, as it starts.
struct Box3 {
  Vec3 lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};
  /// Grows the box so that it contains p.
  void extend(Vec3 p) { lower = min(lower, p), upper = max(upper, p); }
  /// True before the first extend().
  bool empty() const { return lower.x > upper.x; }
  /// The middle; without meaning for an empty box.
  Vec3 centre() const { return (lower + upper) * 0.5f; }
  /// Distance between opposite corners; 0 for an empty box.
  float diagonal() const { return empty() ? 0.0f : length(upper - lower); }
};

}  // namespace base
}  // namespace luxel
