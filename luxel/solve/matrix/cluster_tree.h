// Patches in groups of groups: what distant patches exchange light through.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::matrix {

/// Patches [first, end) of the tree's order.
struct Cluster {
  uint32_t first = 0, end = 0;
  uint32_t child = 0;  ///< its two halves are clusters child and child + 1; 0: a leaf
  uint32_t depth = 0;

  uint32_t size() const { return end - first; }
  bool is_leaf() const { return child == 0; }
};

/// Binary; cluster 0 is all patches; children come after their parents.
struct ClusterTree {
  std::vector<Cluster> clusters;
  std::vector<uint32_t> order;  ///< place k of the tree's order holds patch order[k]
};

/// Halves along the longest side of the box around positions and directions, so that clusters
/// become small and flat. Leaves hold `leaf_size` patches or fewer.
ClusterTree make_cluster_tree(std::span<const Vec3> position, std::span<const Vec3> normal,
                              uint32_t leaf_size);

}  // namespace luxel::matrix
