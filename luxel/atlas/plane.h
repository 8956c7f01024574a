// Double-precision points for work in the plane and on surfaces: charts are projected, turned and
// scaled several times, and a float would not survive that on a large level.
#pragma once

#include <cmath>

#include "luxel/base/vec2_double.h"
#include "luxel/base/vec_double.h"

namespace luxel::atlas {

/// The angle between two unit vectors.
inline double angle_between(DVec3 a, DVec3 b) {
  return std::atan2(length(cross(a, b)), dot(a, b));  // acos loses half its digits near 0
}

}  // namespace luxel::atlas
