// Pieces of straight lines in space, cut by planes and polygons.
#pragma once

#include "luxel/solve/hierarchical/faces.h"

namespace luxel::hierarchical {

struct Segment {
  DVec3 a, b;
};

/// Leaves the part of a segment for which low <= value <= high, where value is linear along it.
/// False when there is none.
bool clip_linear(Segment& segment, double at_a, double at_b, double low, double high);

/// Leaves the part of a segment of the polygon's plane that lies inside. False when there is none.
bool clip_to(PolygonView polygon, DVec3 normal, Segment& segment);

/// The line in which two planes meet, `reach` [m] to both sides of the point nearest to `about`.
/// False when they are parallel.
bool meet(const Plane& p, const Plane& q, DVec3 about, double reach, Segment& out);

}  // namespace luxel::hierarchical
