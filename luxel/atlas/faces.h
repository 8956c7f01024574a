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
  /// World, corner order of the mesh, times scene::layout_density: a surface that is to have twice
  /// the texels per metre is laid out as if it were twice as large.
  std::vector<std::array<DVec3, 3>> corners;
  std::vector<DVec3> normal;  ///< unit, front side
  std::vector<double> area;   ///< of these corners [m^2]
  /// The face on the other side of edge (k, k + 1), or kNone at a border. Vertices are joined by
  /// exact position because files split them at creases and texture seams.
  std::vector<std::array<uint32_t, 3>> across;

  size_t size() const { return corners.size(); }
};

Faces make_faces(const scene::Scene& scene);

/// Makes edges between faces of different groups borders.
void part_groups(Faces& faces, std::span<const uint32_t> group);

}  // namespace luxel::atlas
