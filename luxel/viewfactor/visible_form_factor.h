// The form factor between two convex polygons past opaque ones.
#pragma once

#include <span>

#include "luxel/base/progress.h"
#include "luxel/viewfactor/point_visibility.h"
#include "luxel/viewfactor/polygon_form_factor.h"

namespace luxel::viewfactor {

struct VisibleParams {
  /// Relative error asked for; where less than a thousandth is left to see, that of the thousandth.
  double tolerance = 1e-4;
  double slack_m = 0;  ///< corners closer to a plane lie on it; 0: double rounding
  /// Exchange areas below this [m^2] need no smaller absolute error than this one.
  double negligible_m2 = 0;
  uint32_t max_cells = 1u << 17;  ///< pieces of `a` after which the work ends, tolerance or not
  const Progress* progress = nullptr;  ///< when cancelled, the work ends early
};

/// A_a F(a -> b) [m^2] with the error that was reached.
struct VisibleExchange {
  double value = 0;
  double error = 0;  ///< estimated absolute error [m^2]
  uint32_t cells = 0;
  bool gave_up = false;  ///< at max_cells, with an error above the tolerance
};

/// The polygon on which shadows end less sharply is cut into triangles until the estimated error is
/// small enough. Triangles past which no blocker reaches have the closed form, those that one
/// blocker hides give nothing, and the others are sampled with the exact visibility of the other
/// polygon from points. The cell whose estimate is worst is cut along a shadow line
/// (shadow_lines.h) where what is seen jumps across it, and into four elsewhere. The estimate is
/// the difference that splitting made, and for blockers that no sample has seen how far they reach
/// into the cell's shaft (and no more than their area there: what passes an area S carries no more
/// than S).
VisibleExchange visible_exchange_area(PolygonView a, PolygonView b,
                                      std::span<const Blocker> blockers,
                                      const VisibleParams& params);

/// F(a -> b) with its estimated absolute error.
struct FormFactor {
  double value = 0, error = 0;
};
FormFactor form_factor(PolygonView a, PolygonView b, std::span<const Polygon> blockers = {},
                       double tolerance = 1e-4);

}  // namespace luxel::viewfactor
