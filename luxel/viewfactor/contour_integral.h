// The exchange area of two polygons as a double integral along their outlines.
#pragma once

#include "luxel/viewfactor/polygon_form_factor.h"

namespace luxel::viewfactor {

/// A_a F(a -> b) = 1/(2 pi) sum over edges i of a and j of b of
///     (e_i . e_j)  int_i int_j  ln |x - y|  dy dx                     [Schroeder93, eq. 1;
///     Sparrow63]
/// (the outer integral by quadrature along the edges of a, the smaller one, the inner in closed
/// form) for convex polygons that lie wholly in front of each other. The sum cancels where polygons
/// are small against their distance, which `rounding` tells.
ExchangeArea contour_exchange_area(PolygonView a, PolygonView b, double tolerance);

}  // namespace luxel::viewfactor
