// The shaft between two convex polygons: the hull of both, in which everything lies that can stand
// between them.
#pragma once

#include <vector>

#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// Planes that face outwards: the shaft is where no height is positive. [Haines94]
struct Shaft {
  std::vector<Plane> planes;
  double slack = 0;  ///< what reaches in less than this [m] does not reach in
};

/// Each facet of the hull holds an edge of one polygon and a corner of the other, or is one of the
/// polygons.
Shaft shaft_between(PolygonView a, PolygonView b, double slack);

/// True when the polygon certainly lies outside.
bool is_outside(const Shaft& shaft, PolygonView polygon);
/// True when the box certainly lies outside.
bool is_outside(const Shaft& shaft, DVec3 lower, DVec3 upper);
/// Reach of a polygon into the shaft between a and b.
struct Intrusion {
  double area_m2 = 0;  ///< of the part inside
  /// A guess at the share of lines from a to b that it can hide, from its depth d below the facet
  /// it reaches least beyond: a line that runs d below the facet at the share t of its way has
  /// (1 - t) d_a + t d_b <= d. The share of all lines, d_a < w_a and d_b < w_b below the facet, is
  /// largest at an end of the range of t. Four times that, because lines are not spread evenly; at
  /// most 1.
  double share = 0;
};
Intrusion intrusion(const Shaft& shaft, PolygonView a, PolygonView b, PolygonView polygon);

}  // namespace luxel::viewfactor
