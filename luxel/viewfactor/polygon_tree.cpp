#include "luxel/viewfactor/polygon_tree.h"

#include <algorithm>
#include <numeric>

namespace luxel::viewfactor {
namespace {

constexpr uint32_t kLeafSize = 4;

DVec3 min_of(DVec3 a, DVec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
DVec3 max_of(DVec3 a, DVec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

struct Build {
  std::span<const Polygon> polygons;
  std::vector<DVec3> centres;
  PolygonTree tree;
};

/// Recursion of logarithmic depth: halves.
void build_node(Build& build, uint32_t first, uint32_t count) {
  PolygonTree::Node node{
      {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, first, count, 0};
  for (uint32_t i = first; i < first + count; ++i)
    for (const DVec3& p : build.polygons[build.tree.order[i]])
      node.lower = min_of(node.lower, p), node.upper = max_of(node.upper, p);
  const size_t index = build.tree.nodes.size();
  build.tree.nodes.push_back(node);
  if (count <= kLeafSize) return;
  const DVec3 size = node.upper - node.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto key = [&](uint32_t polygon) {
    const DVec3& c = build.centres[polygon];
    return std::pair(axis == 0 ? c.x : axis == 1 ? c.y : c.z, polygon);
  };
  const auto begin = build.tree.order.begin() + first;
  const uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [&](uint32_t i, uint32_t j) { return key(i) < key(j); });
  build_node(build, first, half);
  build.tree.nodes[index].count = 0;
  build.tree.nodes[index].right_child = uint32_t(build.tree.nodes.size());
  build_node(build, first + half, count - half);
}

}  // namespace

PolygonTree build_polygon_tree(std::span<const Polygon> polygons) {
  Build build{polygons, {}, {}};
  for (const Polygon& polygon : polygons) build.centres.push_back(mean_corner(polygon));
  build.tree.order.resize(polygons.size());
  std::iota(build.tree.order.begin(), build.tree.order.end(), 0u);
  if (!polygons.empty()) build_node(build, 0, uint32_t(polygons.size()));
  return std::move(build.tree);
}

void polygons_near(const PolygonTree& tree, const Shaft& shaft, std::vector<uint32_t>& found) {
  found.clear();
  if (tree.nodes.empty()) return;
  std::vector<uint32_t> stack{0};
  while (!stack.empty()) {
    const uint32_t index = stack.back();
    stack.pop_back();
    const PolygonTree::Node& node = tree.nodes[index];
    if (is_outside(shaft, node.lower, node.upper)) continue;
    if (node.right_child != 0) {
      stack.push_back(index + 1), stack.push_back(node.right_child);
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) found.push_back(tree.order[i]);
  }
  std::sort(found.begin(), found.end());
}

}  // namespace luxel::viewfactor
