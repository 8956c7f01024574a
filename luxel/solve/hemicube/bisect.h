// Cutting triangles in two so that the mesh stays whole.
#pragma once

#include <unordered_map>

#include "luxel/solve/hemicube/mesh.h"

namespace luxel::hemicube {

/// Cuts triangles of a mesh. Keeps which triangles meet at which edge.
class Bisector {
 public:
  explicit Bisector(Mesh& mesh);

  /// Cuts a triangle at its longest edge, and before it whatever must be cut so that no vertex ends
  /// up on another triangle's edge [Rivara84]. Nothing happens to one that is cut already. Stops
  /// before more than `most` triangles would be cut; the mesh is whole then, too.
  void cut(uint32_t node, size_t most = SIZE_MAX);
  /// The square of the longest edge's length [m^2].
  double longest_edge2(uint32_t node) const;

 private:
  using Edge = uint64_t;
  struct Longest {
    double length2 = 0;
    Edge edge = 0;
    uint8_t k = 0;
  };
  Longest longest(uint32_t node) const;
  void link(uint32_t node, uint8_t k);
  void replace(Edge edge, uint32_t node, uint32_t by);
  void cut_all_at(Edge edge);
  void halve(uint32_t node, uint8_t k, uint32_t middle);
  uint32_t middle_vertex(const Node& node, uint8_t k, uint32_t middle);

  Mesh& mesh_;
  std::unordered_map<Edge, std::vector<uint32_t>> triangles_at_;  ///< by the edge's two points
  std::unordered_map<Edge, uint32_t> middle_vertex_;              ///< by the edge's two vertices
};

}  // namespace luxel::hemicube
