// Polygons of files as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec_double.h"

namespace luxel::import {

/// Corners that a polygon may have; readers refuse more.
inline constexpr size_t kMostCorners = 1 << 16;

/// Appends the triangles of a polygon, as numbers of its corners in its own winding: ear clipping
/// [Meisters75] with exact predicates. Seen along the polygon's mean normal, the triangles do not
/// overlap and their areas add up to the polygon's, concave and nearly planar ones included, and
/// those whose holes are joined to the outline by a doubled edge. Triangles without area are left
/// out; a corner on a straight edge stays a corner of triangles. A convex polygon becomes the fan
/// from its first corner. False: the outline crosses itself, so that no triangles are right.
bool triangulate(std::span<const DVec3> corners, std::vector<std::array<uint32_t, 3>>& out);

}  // namespace luxel::import
