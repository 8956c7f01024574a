// Convex planar polygons in double precision: what exact view factors are made of.
#pragma once

#include <span>
#include <vector>

#include "luxel/base/plane.h"

namespace luxel::viewfactor {

/// Corners in the world [m], counter-clockwise seen from the front.
using Polygon = std::vector<DVec3>;
using PolygonView = std::span<const DVec3>;

/// The front side's normal times the area [m^2].
DVec3 area_vector(PolygonView polygon);
inline double area_m2(PolygonView polygon) { return length(area_vector(polygon)); }
/// The plane the polygon lies in; its normal is zero for a polygon without area.
Plane plane_of(PolygonView polygon);
DVec3 mean_corner(PolygonView polygon);
/// The largest distance of a corner from `centre`.
double radius_about(DVec3 centre, PolygonView polygon);
/// The largest absolute coordinate: rounding moves a corner by some 1e-16 of it.
double magnitude(PolygonView polygon);

/// The part of a convex polygon above the plane [Sutherland74]. Corners within `slack` of the plane
/// count as lying on it. Empty when nothing reaches above it.
Polygon clip_above(PolygonView polygon, const Plane& plane, double slack);
/// clip_above() into memory that is there; `above` is none of the polygon.
void clip_above(PolygonView polygon, const Plane& plane, double slack, Polygon& above);

}  // namespace luxel::viewfactor
