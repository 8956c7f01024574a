// A plane in space, in double precision.
#pragma once

#include "luxel/base/vec_double.h"

namespace luxel {
inline namespace base {

/// dot(normal, p) = offset.
struct Plane {
  DVec3 normal;  ///< unit
  double offset = 0;
  double height(DVec3 p) const { return dot(normal, p) - offset; }
};

}  // namespace base
}  // namespace luxel
