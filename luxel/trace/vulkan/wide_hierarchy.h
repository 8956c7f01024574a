// A hierarchy with up to eight children a node, whose boxes take a byte a number.
#pragma once

#include "luxel/trace/vulkan/binary_hierarchy.h"

namespace luxel::trace {

/// A node as [Ylitie17, section 3.2] packs it. Boxes of children are whole multiples of
/// `2^exponent` from `origin`, rounded outwards. A child lies in the slot (0 to 7) that tells its
/// direction from the node's middle: bit 2 is set where it lies towards +x, bit 1 +y, bit 0 +z.
struct WideNode {
  static constexpr uint8_t kInner = 0b001'11'000;  ///< in meta: an inner node, its slot added
  static constexpr uint32_t kMostInLeaf = 3;

  Vec3 origin;
  std::array<uint8_t, 3> exponent{};  ///< + 127, as floats have it
  uint8_t inner = 0;                  ///< a bit for each slot with a node
  uint32_t first_node = 0;            ///< inner children follow each other in the order of slots
  uint32_t first_triangle = 0;        ///< triangles of all leaves follow each other
  /// Per slot: 0: empty; an inner node: kInner + slot; a leaf: in the upper three bits as many ones
  /// as it has triangles, in the lower five its first one's place behind first_triangle.
  std::array<uint8_t, 8> meta{};
  std::array<uint8_t, 8> lower_x{}, lower_y{}, lower_z{}, upper_x{}, upper_y{}, upper_z{};
};
static_assert(sizeof(WideNode) == 80);

struct WideHierarchy {
  std::vector<WideNode> nodes;            ///< the root first; never empty
  std::vector<DeviceTriangle> triangles;  ///< in the order of the leaves
};

/// Joins nodes of a binary hierarchy whose leaves have at most WideNode::kMostInLeaf triangles: of
/// a node's children the one with the largest box is taken apart, until there are eight
/// [Wald08]; the paper finds the best ones of all. Boxes grow by 2^-20 of `reach`, more than what
/// rounding moves a ray by that begins so far from the origin.
WideHierarchy widen(const BinaryHierarchy& binary, float reach);

/// Reach about the origin of rays that begin in a box: its diagonal plus its largest coordinate.
float reach_of(const Box3& box);

}  // namespace luxel::trace
