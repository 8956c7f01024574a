// The form factor from a point to a polygon, in closed form.
#pragma once

#include <span>

#include "luxel/base/vec.h"
#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// F(dA -> polygon): the fraction of what a differential element at `point` with unit `normal`
/// radiates that arrives at the polygon, nothing in between. The polygon (convex, planar, 3 or 4
/// corners) counts when its corners are counter-clockwise seen from the point; the part below the
/// element's horizon is clipped away. Lambert's formula [Schroeder93, eq. 3]:
///   F = 1/(2 pi) sum_k  gamma_k  n . (r_k x r_k+1) / |r_k x r_k+1|
/// with gamma_k the angle between the directions r_k and r_k+1 to neighbouring corners.
/// Relative error about 1e-9 (double inside) unless the polygon is smaller than 1e-6 rad.
double point_to_polygon(Vec3 point, Vec3 normal, std::span<const Vec3> polygon);
/// Lambert's factor in double precision, for any number of corners.
double point_to_polygon(DVec3 point, DVec3 normal, PolygonView polygon);

}  // namespace luxel::viewfactor
