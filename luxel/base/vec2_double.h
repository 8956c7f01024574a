// Double-precision vectors of the plane.
#pragma once

#include <cmath>

#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

struct DVec2 {
  double x = 0, y = 0;
};

inline DVec2 operator+(DVec2 a, DVec2 b) { return {a.x + b.x, a.y + b.y}; }
inline DVec2 operator-(DVec2 a, DVec2 b) { return {a.x - b.x, a.y - b.y}; }
inline DVec2 operator*(DVec2 a, double s) { return {a.x * s, a.y * s}; }
inline double dot(DVec2 a, DVec2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(DVec2 a, DVec2 b) { return a.x * b.y - a.y * b.x; }
inline double length(DVec2 a) { return std::sqrt(dot(a, a)); }
inline DVec2 to_double(Vec2 a) { return {a.x, a.y}; }

}  // namespace base
}  // namespace luxel
