// Double-precision points for work in the plane and on surfaces: charts are projected, turned and
// scaled several times, and a float would not survive that on a large level.
#pragma once

#include <array>
#include <cmath>

#include "base/vec_double.h"

namespace luxel::atlas {

struct Dvec2 {
  double x = 0, y = 0;
};
inline Dvec2 operator+(Dvec2 a, Dvec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Dvec2 operator-(Dvec2 a, Dvec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Dvec2 operator*(Dvec2 a, double s) { return {a.x * s, a.y * s}; }
inline double dot(Dvec2 a, Dvec2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(Dvec2 a, Dvec2 b) { return a.x * b.y - a.y * b.x; }
inline double length(Dvec2 a) { return std::sqrt(dot(a, a)); }
inline Dvec2 to_double(Vec2 a) { return {a.x, a.y}; }

/// The angle between two unit vectors.
inline double angle_between(DVec3 a, DVec3 b) {
  return std::atan2(length(cross(a, b)), dot(a, b));  // acos loses half its digits near 0
}

}  // namespace luxel::atlas
