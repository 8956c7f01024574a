#include "luxel/light/light_tree.h"

#include <algorithm>
#include <cmath>

#include "luxel/light/both_light_group.h"
#include "luxel/light/spherical_triangle.h"

namespace luxel::light {
namespace {

/// The narrowest cone about both nodes' cones.
void join_cones(const LightNode& p, const LightNode& q, LightNode& out) {
  const LightNode &wide = p.angle_rad >= q.angle_rad ? p : q,
                  &other = p.angle_rad >= q.angle_rad ? q : p;
  const float between = angle_between(wide.axis, other.axis);
  if (between + other.angle_rad <= wide.angle_rad) return set_cone(out, wide.axis, wide.angle_rad);
  const float half = 0.5f * (wide.angle_rad + between + other.angle_rad);
  const Vec3 across = other.axis - wide.axis * dot(wide.axis, other.axis);
  if (half >= kPi || !(dot(across, across) > 1e-12f)) return set_cone(out, wide.axis, kPi);
  const float turn = half - wide.angle_rad;
  set_cone(out, wide.axis * std::cos(turn) + normalize(across) * std::sin(turn), half);
}

void build_node(std::span<LightLeaf> leaves, uint32_t first, std::vector<LightNode>& nodes) {
  const size_t self = nodes.size(), count = leaves.size();
  if (count == 1) {
    nodes.push_back(leaves[0].node);
    nodes[self].first = first, nodes[self].count = 1, nodes[self].right_child = 0;
    nodes[self].centre = leaves[0].bounds.centre();
    nodes[self].radius_m = 0.5f * leaves[0].bounds.diagonal();
    return;
  }
  nodes.push_back({});
  LightNode node;
  Box3 bounds, places;
  for (const LightLeaf& leaf : leaves) {
    bounds.extend(leaf.bounds.lower), bounds.extend(leaf.bounds.upper);
    places.extend(leaf.place);
  }
  const Vec3 size = places.upper - places.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::stable_sort(leaves.begin(), leaves.end(),
                   [axis](const auto& p, const auto& q) { return p.place[axis] < q.place[axis]; });
  build_node(leaves.subspan(0, count / 2), first, nodes);
  node.right_child = uint32_t(nodes.size());
  build_node(leaves.subspan(count / 2), first + uint32_t(count / 2), nodes);
  const LightNode &left = nodes[self + 1], &right = nodes[node.right_child];
  node.centre = bounds.centre(), node.radius_m = 0.5f * bounds.diagonal();
  node.first = first, node.count = uint32_t(count);
  node.power = left.power + right.power;
  node.reach_m = std::max(left.reach_m, right.reach_m);
  const float share = left.power / node.power;
  node.facing = left.facing * share + right.facing * (1 - share);
  // Normals that point apart make the sum of the clamped cosines more even: of all directions
  // alike, the mean of max(0, cos) is 1/4.
  const float lost =
      share * length(left.facing) + (1 - share) * length(right.facing) - length(node.facing);
  node.even = left.even * share + right.even * (1 - share) + 0.25f * std::max(0.0f, lost);
  join_cones(left, right, node);
  nodes[self] = node;
}

}  // namespace

void set_cone(LightNode& node, Vec3 axis, float angle_rad) {
  // Narrower, the apex would be too far behind for floats; as wide as that, it is everything.
  constexpr float kNarrowest = 0.01f, kWidest = kPi - 0.01f;
  node.axis = axis;
  node.angle_rad = angle_rad >= kWidest ? kPi : std::max(angle_rad, kNarrowest);
  node.cos_angle = node.angle_rad == kPi ? -1 : std::cos(node.angle_rad);
  node.sin_angle = node.angle_rad == kPi ? 0 : std::sin(node.angle_rad);
}

std::vector<LightNode> build_light_tree(std::vector<LightLeaf>& leaves) {
  std::vector<LightNode> nodes;
  if (!leaves.empty()) build_node(leaves, 0, nodes);
  return nodes;
}

float importance_at(const LightNode& node, Vec3 position, Vec3 normal) {
  return both::importance_of({node.centre, node.radius_m, node.power, node.facing, node.even,
                              node.axis, node.cos_angle, node.sin_angle, node.reach_m},
                             position, normal);
}

}  // namespace luxel::light
