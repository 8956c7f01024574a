// A leaf of a face as triangles, with lines as edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/solve/hierarchical/dsets.h"

namespace luxel::hierarchical {

struct Triangulation {
  std::vector<DVec2> points;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise
};

/// Constrained Delaunay triangulation of a convex polygon, with exact predicates. `outline` is
/// counter-clockwise and may have corners on straight edges; `lines` end on it or inside. Lines
/// that cross get a corner there. Points closer to each other than `least_m` become one.
Triangulation triangulate(std::span<const DVec2> outline, std::span<const Segment2> lines,
                          double least_m);

}  // namespace luxel::hierarchical
