// T-junctions: vertices that lie on edges of triangles which do not have them. Rounding opens
// cracks there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// A vertex so far off an edge still lies on it, in diagonals of the scene.
inline constexpr double kOnEdge = 1e-6;

/// An instance before its mesh was cut.
struct Uncut {
  uint32_t vertices = 0;  ///< the first ones of its mesh; the others are new
  /// Per triangle of the mesh as it is, the corners of the one it is a part of; empty: none was
  /// cut.
  std::vector<std::array<uint32_t, 3>> whole;
};

/// Divides triangles at vertices in the midst of their edges, where that is new: the vertex is, or
/// the edge lies within a triangle that was cut. What the file had stays as it is. Vertices of all
/// instances count. An instance that shares its mesh gets one of its own. `before` has an entry per
/// instance.
///
/// Returns, per instance and appended triangle, the one it was a part of.
std::vector<std::vector<uint32_t>> close_t_junctions(Scene& scene, std::vector<Uncut> before);

}  // namespace luxel::scene
