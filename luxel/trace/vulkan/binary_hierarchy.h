// A hierarchy of boxes around triangles, for rays on a graphics device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"

namespace luxel::trace {

/// A triangle as devices read it: the corners as the mesh has them, moved into the world.
struct DeviceTriangle {
  Vec3 a;
  uint32_t number = 0;  ///< in the numbering of scene::first_triangles()
  Vec3 b;
  uint32_t mirrored = 0;  ///< 1: its instance mirrors, so that the front is where a, b, c turn
                          ///< right; 2: see kStandsForInstance
  Vec3 c;
  uint32_t see_through = 0;  ///< number in SeeThrough::triangles, counted from 1; 0: it blocks
};
static_assert(sizeof(DeviceTriangle) == 48);

/// Appends the triangles of a mesh that stands so, but for the second of two sides of one sheet:
/// rays meet the first, which stands for both. They are numbered from `first` on.
void add_triangles(const scene::Mesh& mesh, const Mat34& world_from_object, uint32_t first,
                   std::vector<DeviceTriangle>& out);

/// A node's child: another node, or a few triangles in a row.
struct ChildRef {
  static constexpr uint32_t kLeaf = 1u << 31;
  /// Three bits for a count. 7 stands for an instance on the stacks of devices (binary.glsl).
  static constexpr uint32_t kCountShift = 28, kCountMask = 7, kMaxCount = 6;
  static constexpr uint32_t kFirstMask = (1u << kCountShift) - 1;

  static constexpr uint32_t leaf(uint32_t first, uint32_t count) {
    return kLeaf | count << kCountShift | first;
  }
  static constexpr bool is_leaf(uint32_t ref) { return (ref & kLeaf) != 0; }
  static constexpr uint32_t count(uint32_t ref) { return ref >> kCountShift & kCountMask; }
  static constexpr uint32_t first(uint32_t ref) { return ref & kFirstMask; }
};

/// The boxes of two children. A leaf without triangles has a box of no size.
struct BinaryNode {
  Vec3 lower0;
  uint32_t child0 = ChildRef::leaf(0, 0);
  Vec3 upper0;
  uint32_t child1 = ChildRef::leaf(0, 0);
  Vec3 lower1;
  uint32_t unused0 = 0;
  Vec3 upper1;
  uint32_t unused1 = 0;
};
static_assert(sizeof(BinaryNode) == 64);

/// No path from the root is longer: what the stacks of devices hold.
inline constexpr int kMaxHierarchyDepth = 64;

struct BinaryHierarchy {
  std::vector<BinaryNode> nodes;          ///< the root first; never empty
  std::vector<DeviceTriangle> triangles;  ///< in the order of the leaves
};

/// Sorts triangles by the surface area heuristic over 16 bins per axis [Wald07]. Fewer than 2^28 -
/// 1 triangles. The same bits for any number of threads.
BinaryHierarchy sort_into_hierarchy(std::vector<DeviceTriangle> triangles,
                                    uint32_t most_in_leaf = 4);

}  // namespace luxel::trace
