#include "luxel/solve/matrix/cluster_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace luxel::matrix {
namespace {

/// Opposite directions count like places this many cluster sizes apart: of a room's clusters,
/// walls are told apart first.
constexpr float kDirectionWeight = 16;
/// A half smaller than this part makes the tree deep; the median is taken instead.
constexpr float kSmallestHalf = 0.2f;

using Key = std::array<float, 6>;

Key key_of(Vec3 position, Vec3 normal, float size_m) {
  const Vec3 n = normal * (kDirectionWeight * size_m / 2);
  return {position.x, position.y, position.z, n.x, n.y, n.z};
}

float extent_m(std::span<const Vec3> position, std::span<const uint32_t> patches) {
  Vec3 lower = position[patches.front()], upper = lower;
  for (const uint32_t p : patches) lower = min(lower, position[p]), upper = max(upper, position[p]);
  return max_component(upper - lower);
}

/// Sorts `patches` into two halves and returns the size of the first.
size_t split(std::span<const Vec3> position, std::span<const Vec3> normal,
             std::span<uint32_t> patches) {
  const float size_m = extent_m(position, patches);
  const auto key = [&](uint32_t p) { return key_of(position[p], normal[p], size_m); };
  Key lower = key(patches.front()), upper = lower;
  for (const uint32_t p : patches)
    for (size_t k = 0; k < lower.size(); ++k) {
      lower[k] = std::min(lower[k], key(p)[k]), upper[k] = std::max(upper[k], key(p)[k]);
    }
  size_t axis = 0;
  for (size_t k = 1; k < lower.size(); ++k)
    if (upper[k] - lower[k] > upper[axis] - lower[axis]) axis = k;
  std::stable_sort(patches.begin(), patches.end(),
                   [&](uint32_t a, uint32_t b) { return key(a)[axis] < key(b)[axis]; });
  const float middle = 0.5f * (lower[axis] + upper[axis]);
  const auto half = std::partition_point(patches.begin(), patches.end(),
                                         [&](uint32_t p) { return key(p)[axis] < middle; });
  const auto count = size_t(half - patches.begin());
  const auto least = size_t(kSmallestHalf * float(patches.size()));
  if (axis < 3 && (count <= least || count + least >= patches.size())) return patches.size() / 2;
  return count;
}

}  // namespace

ClusterTree make_cluster_tree(std::span<const Vec3> position, std::span<const Vec3> normal,
                              uint32_t leaf_size) {
  ClusterTree tree;
  tree.order.resize(position.size());
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  tree.clusters.push_back({0, uint32_t(position.size()), 0, 0});
  for (size_t c = 0; c < tree.clusters.size(); ++c) {
    const Cluster whole = tree.clusters[c];
    if (whole.size() <= std::max(leaf_size, 1u)) continue;
    const auto half =
        uint32_t(split(position, normal, std::span(tree.order).subspan(whole.first, whole.size())));
    tree.clusters[c].child = uint32_t(tree.clusters.size());
    tree.clusters.push_back({whole.first, whole.first + half, 0, whole.depth + 1});
    tree.clusters.push_back({whole.first + half, whole.end, 0, whole.depth + 1});
  }
  return tree;
}

}  // namespace luxel::matrix
