// The functions by which clusters of patches see each other: orthonormal over the cluster, and each
// a combination of the functions of its halves.
#pragma once

#include "luxel/solve/matrix/hierarchical.h"

namespace luxel::matrix {

/// The functions of a cluster at a patch.
using Values = std::array<float, kFunctions>;

/// Where a cluster lies.
struct Ball {
  Vec3 centre;
  float radius_m = 0;
};

struct ClusterFunctions {
  std::vector<Ball> ball;  ///< per cluster
  /// Per depth and patch, the functions of the patch's cluster there: 1, then the directions in
  /// which the cluster is widest, orthonormal in the inner product by area. Zero where there are
  /// none.
  std::vector<std::vector<Values>> phi;
};
/// Functions of all clusters; positions and areas per patch, in the order of the tree.
ClusterFunctions make_functions(std::span<const Cluster> clusters, std::span<const Vec3> position,
                                std::span<const float> area_m2);

/// The functions of clusters in terms of those of their halves.
std::vector<Hierarchical::Up> make_up(const ClusterFunctions& functions,
                                      std::span<const Cluster> clusters,
                                      std::span<const float> area_m2);

}  // namespace luxel::matrix
