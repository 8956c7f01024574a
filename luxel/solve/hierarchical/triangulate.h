// A leaf of a face as triangles, with lines as edges.
#pragma once

#include "luxel/solve/hierarchical/constrained_delaunay.h"
#include "luxel/solve/hierarchical/dsets.h"

namespace luxel::hierarchical {

/// Constrained Delaunay triangulation of a convex polygon. `outline` is counter-clockwise and may
/// have corners on straight edges; `lines` end on it or inside. Lines that cross get a corner
/// there. Points closer to each other than `least_m` become one.
Triangulation triangulate(std::span<const DVec2> outline, std::span<const Segment2> lines,
                          double least_m);

}  // namespace luxel::hierarchical
