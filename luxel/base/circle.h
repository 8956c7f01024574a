// Points of the circle and their angles, for the middle of loops: without branches and calls, so
// that compilers make vector code of them, which the standard library's functions prevent.
#pragma once

#include "luxel/base/both_angle.h"
#include "luxel/base/both_circle.h"

namespace luxel {
inline namespace base {

/// cos and sin of 2 pi x for x in [0, 1), to 4e-7.
using both::unit_circle;

/// atan2(y, x), to 4e-7, where zeros have no sign; 0 for (0, 0).
using both::angle_of;

}  // namespace base
}  // namespace luxel
