// A tree that finds the polygons between two others, among thousands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/viewfactor/shaft.h"

namespace luxel::viewfactor {

/// A binary tree of boxes around polygons, split at the median of the longest side.
struct PolygonTree {
  struct Node {
    DVec3 lower, upper;
    uint32_t first = 0, count = 0;  ///< of `order`; an inner node has count 0
    uint32_t right_child = 0;       ///< the left child follows its parent
  };
  std::vector<Node> nodes;
  std::vector<uint32_t> order;
};

PolygonTree build_polygon_tree(std::span<const Polygon> polygons);

/// The polygons whose boxes may reach into the shaft, in ascending order.
void polygons_near(const PolygonTree& tree, const Shaft& shaft, std::vector<uint32_t>& found);

}  // namespace luxel::viewfactor
