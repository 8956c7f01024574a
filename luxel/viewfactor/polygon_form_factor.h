// The form factor between two convex polygons that see each other whole.
#pragma once

#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// F(a -> b): the fraction of what the front side of `a` radiates that arrives at the front side
/// of `b`, nothing in between. Convex planar polygons of 3 corners or more; the parts of each that
/// lie behind the other are clipped away. Exactly 0 for polygons in one plane, polygons that turn
/// their backs and polygons without area. Relative error about 1e-10, also where polygons share an
/// edge or a corner; 1e-7 and more where they are slivers or close to one plane, because there the
/// rounding of the corners themselves matters. See docs/method/view-factors.md.
double polygon_form_factor(PolygonView a, PolygonView b);

/// The exchange area A_a F(a -> b) = A_b F(b -> a) [m^2], and the part of it that rounding may
/// have spoilt.
struct ExchangeArea {
  double value = 0;
  double rounding = 0;  ///< an estimate, of the same unit
};
/// `tolerance` is the relative error asked of the quadrature; `slack` [m] the distance below which
/// a corner counts as lying in the other polygon's plane (0: that of double rounding).
ExchangeArea polygon_exchange_area(PolygonView a, PolygonView b, double tolerance = 1e-12,
                                   double slack = 0);

}  // namespace luxel::viewfactor
