// Joins pieces of triangles again that nothing keeps apart.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// The origin and the group of each triangle of a mesh that has been cut.
struct CutTriangles {
  std::vector<uint32_t> part_of;  ///< the number it had before; that of a whole one is its own
  std::vector<uint32_t> group;    ///< pieces of different groups stay apart
};

/// Removes vertices from `first_vertex` on that cut_mesh() has added, where the pieces around one
/// can do without it: it moves into a neighbour [Hoppe93, edge collapse], such that each
/// triangle's pieces of each group cover what they covered. So all surfaces, borders of groups and
/// neighbours across edges stay as they were, up to the rounding of single precision, and so do
/// attributes, which are linear over a triangle. Triangles with two sides keep them tied.
///
/// The first piece of a triangle has its number, the others come after all triangles. `cut` has an
/// entry for each triangle, before and after.
void join_pieces(Mesh& mesh, CutTriangles& cut, uint32_t first_vertex);

}  // namespace luxel::scene
