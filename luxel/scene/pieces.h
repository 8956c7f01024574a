// Triangles of a mesh that are replaced by pieces of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::scene {

using Corners = std::array<uint32_t, 3>;

/// An order of places, by which both triangles at an edge agree where it begins.
inline bool is_lower(Vec3 p, Vec3 q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); }

/// Appends a vertex on the edge from `low` to `high`, at the share `s` of it: attributes are
/// interpolated.
uint32_t append_between(Mesh& mesh, uint32_t low, uint32_t high, float s);

/// Replaces triangles of a mesh: the first piece of one stays where it was, the others are
/// appended.
class PieceWriter {
 public:
  explicit PieceWriter(Mesh& mesh) : mesh_(mesh) {}
  /// `pieces` fill the triangle. One and its other side must be replaced by the same pieces, in any
  /// order.
  void replace(uint32_t triangle, std::span<const Corners> pieces);
  /// Ties the pieces of both sides of sheets. Returns, per appended triangle, the one it was a part
  /// of.
  std::vector<uint32_t> finish();

 private:
  Mesh& mesh_;
  std::vector<uint32_t> part_of_;
  std::unordered_map<uint32_t, std::vector<uint32_t>> sides_;  ///< pieces of triangles of sheets
};

}  // namespace luxel::scene
