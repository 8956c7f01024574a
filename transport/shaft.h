// The shaft between two convex polygons: the hull of both, in which everything lies that can stand
// between them.
#pragma once

#include <vector>

#include "transport/polygon.h"

namespace luxel::transport {

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
/// The area of the part of the polygon that lies inside [m^2].
double area_inside(const Shaft& shaft, PolygonView polygon);

}  // namespace luxel::transport
