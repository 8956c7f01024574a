// The drawn triangles in the world, and which of them are neighbours on the surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/plane.h"
#include "luxel/scene/scene.h"

namespace luxel::atlas {

/// All drawn triangles, numbered as scene::first_triangles does.
struct Faces {
  std::vector<std::array<DVec3, 3>> corners;  ///< world, corner order of the mesh
  std::vector<DVec3> normal;                  ///< unit, front side
  std::vector<double> area;                   ///< m^2
  /// The face on the other side of edge (k, k + 1), or kNone at a border. Vertices are joined by
  /// exact position because files split them at creases and texture seams.
  std::vector<std::array<uint32_t, 3>> across;

  size_t size() const { return corners.size(); }
};

Faces make_faces(const scene::Scene& scene);

/// Makes edges between faces of different groups borders.
void part_groups(Faces& faces, std::span<const uint32_t> group);

}  // namespace luxel::atlas
