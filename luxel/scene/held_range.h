// Numbers of a scene that single precision can hold. All solvers and the ray tracer compute in it.
#pragma once

#include <cfloat>
#include <cmath>

#include "luxel/base/vec.h"

namespace luxel::scene {

/// Coordinates of surfaces and cameras, largest magnitude [m]. The highest power of a length that
/// is computed with is the fourth: |n|^2 of n = e1 x e2, before it is made a unit vector. |n| is at
/// most 2 sqrt(3) c^2 for corners within [-c, c]^3 (the largest triangle of a cube), so |n|^2 is
/// 1.2e37 here, and boxes have diagonals whose fourth power is 1.4e38; FLT_MAX is 3.4e38.
///
/// Larger coordinates are refused, not scaled inside. Measured: a room scaled by powers of two from
/// 2^-20 to 2^28, its lamps by their squares, has the same bits of light by every solver
/// (hierarchical: less than 1 % else; tests/unit_of_length_test.cpp). So scaling inside would give
/// what another unit in the modeller gives, but each length that comes in by an option or a script,
/// and each that goes out into a file or a sentence, would have to know the factor. Places alone
/// know an origin (Scene::origin): there are few of them.
inline constexpr float kFarthest_m = 1e9f;

/// Coordinates of point and spot lights, largest magnitude [m]: rays go towards them, but no box
/// holds them, so that squares of distances suffice. The sun as a point light is 1.5e11 m away.
inline constexpr float kFarthestLight_m = 1e18f;

/// Twice the area of a triangle, least [m^2]: its square would lose digits below. An equilateral
/// triangle of it has edges of 3.5e-10 m.
inline constexpr float kLeastDoubleArea_m2 = 0x1p-63f;
static_assert(kLeastDoubleArea_m2 * kLeastDoubleArea_m2 == FLT_MIN);

/// True: no coordinate is NaN or of larger magnitude than `farthest_m`.
inline bool is_held(Vec3 p, float farthest_m = kFarthest_m) {
  return std::abs(p.x) <= farthest_m && std::abs(p.y) <= farthest_m && std::abs(p.z) <= farthest_m;
}

/// The vector can be made a unit vector, also on threads that flush denormals to zero.
inline bool has_unit_vector(Vec3 n) {
  const float length2 = dot(n, n);
  return length2 >= FLT_MIN && std::isfinite(length2);
}

}  // namespace luxel::scene
