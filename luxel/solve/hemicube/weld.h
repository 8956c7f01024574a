// Corners of a scene's triangles that are one point, and those that are one vertex.
#pragma once

#include <array>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::hemicube {

/// Corners of all drawn triangles, numbered.
struct Welded {
  std::vector<Vec3> points;                     ///< world
  std::vector<scene::SurfacePoint> vertices;    ///< one of the corners that are this vertex
  std::vector<uint32_t> point_of;               ///< per vertex
  std::vector<std::array<uint32_t, 3>> vertex;  ///< per drawn triangle and corner
};

/// Corners are one point when they belong to one instance and their positions are equal; one vertex
/// when, besides, the normals there differ by less than 3 degrees and the material is the same.
/// Where a vertex normal leans more than 60 degrees away from a triangle it is not that of a smooth
/// surface, and the triangle's own counts.
Welded weld(const scene::Scene& scene);

}  // namespace luxel::hemicube
