// Sheets of triangles over a grid.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Two triangles for each cell of a grid of quads x quads cells over the mesh's (quads + 1)^2
/// vertices, row by row; all of the first material. With x along a row and z from row to row their
/// fronts look up.
inline void add_grid_triangles(Mesh& mesh, int quads) {
  const auto at = [&](int i, int j) { return uint32_t(j) * uint32_t(quads + 1) + uint32_t(i); };
  for (int j = 0; j < quads; ++j)
    for (int i = 0; i < quads; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
}

}  // namespace luxel::scene
