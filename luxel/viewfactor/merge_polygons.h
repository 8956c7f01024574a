// Triangles of one plane, joined again to the convex polygons that they once were.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

struct MergedPolygons {
  std::vector<Polygon> polygons;
  /// Per triangle: the polygon it is part of; kNoPolygon for one without area.
  std::vector<uint32_t> of_triangle;
};
inline constexpr uint32_t kNoPolygon = ~0u;

/// Joins neighbours (polygons with a common edge, corners equal bit by bit) that lie in one plane
/// to within `slack` [m] and whose union is convex, greedily, until none are left; then drops
/// corners on straight edges. Triangles without area are left out. The exchange of light is the
/// same and costs a fourth or less for each pair of quads. The time is nearly proportional to the
/// number of triangles. Advances `progress` by one for each triangle. Errors: cancelled.
Result<MergedPolygons> merge_polygons(std::span<const std::array<DVec3, 3>> triangles, double slack,
                                      Progress& progress);

}  // namespace luxel::viewfactor
