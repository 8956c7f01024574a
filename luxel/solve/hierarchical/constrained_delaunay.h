// Triangles between points and lines, as well shaped as the lines let them be.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec2_double.h"

namespace luxel::hierarchical {

struct Triangulation {
  std::vector<DVec2> points;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise
};

/// Constrained Delaunay triangulation of the convex hull of `points`: no circle through the corners
/// of a triangle holds a corner of its neighbour, except across a constraint. Constraints are pairs
/// of points, and edges cover them. One that passes through a point, or by it within rounding, is
/// divided there. Two that cross are divided at their crossing, rounded, which becomes a point. All
/// finite points will do, because the decisions are exact. Of equal ones one is kept. Points on one
/// line have no triangles.
Triangulation constrained_delaunay(std::span<const DVec2> points,
                                   std::span<const std::array<uint32_t, 2>> constraints);

}  // namespace luxel::hierarchical
