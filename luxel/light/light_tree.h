// A binary tree over lights: what a receiver far away needs to know of a group. [Walter05, Conty18]
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::light {

/// A light, or a group of them that lie together in the order of the leaves.
struct LightNode {
  Vec3 centre;
  float radius_m = 0;  ///< of the sphere about the centre that holds all of it
  float power = 0;  ///< triangles: sum of luminance(radiance) * area * sides; lights: of intensity
  /// Spread of the power over directions d, at least about even + max(0, d . facing).
  Vec3 facing{};
  float even = 1;
  /// No light leaves by an angle of more than `angle` to the axis, nor arrives beyond the reach.
  Vec3 axis{0, 0, 1};
  float angle_rad = kPi, cos_angle = -1, sin_angle = 0;
  float reach_m = INFINITY;
  uint32_t first = 0, count = 0;  ///< lights
  uint32_t right_child = 0;       ///< the left child follows its parent; 0: a leaf of one light
};

/// One light of a tree, with its place in the caller's list.
struct LightLeaf {
  Box3 bounds;
  Vec3 place;  ///< by which groups are formed
  LightNode node;
  uint32_t index = 0;
};

/// Depth first, node 0 the root; halves at the median of the longest axis of the places. `leaves`
/// end up in the order of the tree.
std::vector<LightNode> build_light_tree(std::vector<LightLeaf>& leaves);

/// Luminance of the irradiance from a node, nothing in between: an estimate that is zero only where
/// nothing can arrive.
float importance_at(const LightNode& node, Vec3 position, Vec3 normal);

/// Sets the cone and what follows from it.
void set_cone(LightNode& node, Vec3 axis, float angle_rad);

}  // namespace luxel::light
