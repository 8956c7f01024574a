// Exact signs of two determinants, whatever the rounding: the decisions of plane geometry.
#pragma once

#include "luxel/base/vec2_double.h"

namespace luxel {
inline namespace base {

/// 1 where a, b, c turn left (counter-clockwise), -1 where they turn right, 0 on one line. Exact
/// for all finite coordinates, as is in_circle. [Shewchuk97, section 4]
int orientation(DVec2 a, DVec2 b, DVec2 c);

/// 1 where d lies inside the circle through a, b, c, -1 outside, 0 on it. a, b, c turn left; where
/// they turn right the sign is the opposite.
int in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d);

}  // namespace base
}  // namespace luxel
