#include "luxel/trace/vulkan/binary_hierarchy.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::trace {
namespace {

constexpr size_t kBins = 16;
/// The costs of the heuristic: stepping into a node, over testing a triangle.
constexpr float kNodeCost = 1.5f;
/// From this depth on nodes are halved by number, which ends within 28 further levels.
constexpr int kHalvedFrom = 32;
/// Subtrees of fewer triangles are built by one thread.
constexpr uint32_t kSubtree = 1u << 14;

/// A triangle's box, and its middle.
struct Entry {
  Box3 box;
  uint32_t triangle = 0;

  Vec3 middle() const { return box.centre(); }
};

void grow(Box3& box, const Box3& by) {
  box.lower = min(box.lower, by.lower), box.upper = max(box.upper, by.upper);
}

float area(const Box3& b) {
  const Vec3 d = b.upper - b.lower;
  return d.x < 0 ? 0 : 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
}

float at(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

struct Bounds {
  Box3 box, middles;
};
Bounds bounds_of(std::span<const Entry> entries) {
  Bounds out;
  for (const Entry& e : entries) grow(out.box, e.box), out.middles.extend(e.middle());
  return out;
}

/// Where a node is cut: entries whose middle's bin along the axis is below `bin` go to the left.
struct Cut {
  int axis = -1;  ///< -1: none is worth it
  size_t bin = 0;
  float cost = INFINITY;  ///< of the two halves, in triangle tests times area
};

struct Bin {
  Box3 box;
  uint32_t count = 0;
};

size_t bin_of(const Box3& middles, Vec3 middle, int axis) {
  const float low = at(middles.lower, axis), size = at(middles.upper, axis) - low;
  const float place = (at(middle, axis) - low) / size * float(kBins);
  // Not what is no number, where a scene is larger than floats.
  return place > 0 ? size_t(std::min(place, float(kBins - 1))) : 0;
}

Cut best_cut_along(std::span<const Entry> entries, const Bounds& bounds, int axis) {
  Cut best;
  if (!(at(bounds.middles.upper, axis) > at(bounds.middles.lower, axis))) return best;
  std::array<Bin, kBins> bins;
  for (const Entry& e : entries) {
    Bin& bin = bins[bin_of(bounds.middles, e.middle(), axis)];
    grow(bin.box, e.box), ++bin.count;
  }
  std::array<float, kBins> right{};  // cost of bin k and all after it
  Bin sum;
  for (size_t k = kBins; k-- > 1;) {
    grow(sum.box, bins[k].box), sum.count += bins[k].count;
    right[k] = float(sum.count) * area(sum.box);
  }
  sum = {};
  for (size_t k = 1; k < kBins; ++k) {
    grow(sum.box, bins[k - 1].box), sum.count += bins[k - 1].count;
    const float cost = float(sum.count) * area(sum.box) + right[k];
    if (sum.count > 0 && sum.count < entries.size() && cost < best.cost) best = {axis, k, cost};
  }
  return best;
}

/// Parts entries in two; returns how many are in the first part, 0 where a leaf is better.
size_t part(std::span<Entry> entries, const Bounds& bounds, int depth, uint32_t most_in_leaf) {
  const size_t n = entries.size();
  Cut best;
  if (depth < kHalvedFrom)
    for (int axis = 0; axis < 3; ++axis) {
      const Cut cut = best_cut_along(entries, bounds, axis);
      if (cut.cost < best.cost) best = cut;
    }
  const float whole = area(bounds.box);
  if (n <= most_in_leaf && kNodeCost * whole + best.cost >= float(n) * whole) return 0;
  if (best.axis < 0) return n / 2;
  const auto middle = std::partition(entries.begin(), entries.end(), [&](const Entry& e) {
    return bin_of(bounds.middles, e.middle(), best.axis) < best.bin;
  });
  return size_t(middle - entries.begin());
}

/// Entries [first, first + count) of all, which become the child `side` of a node.
struct Task {
  uint32_t first = 0, count = 0, node = 0, side = 0;
  int depth = 0;
};

void set_child(BinaryNode& node, uint32_t side, const Box3& box, uint32_t ref) {
  (side == 0 ? node.lower0 : node.lower1) = box.lower;
  (side == 0 ? node.upper0 : node.upper1) = box.upper;
  (side == 0 ? node.child0 : node.child1) = ref;
}

/// Builds what `task` stands for into `nodes`. With `later`, parts of few triangles are put there
/// in place of being built.
void build(std::span<Entry> all, const Task& task, uint32_t most_in_leaf,
           std::vector<BinaryNode>& nodes, std::vector<Task>* later) {
  std::vector<Task> todo{task};
  while (!todo.empty()) {
    const Task t = todo.back();
    todo.pop_back();
    if (later && t.count <= kSubtree) {
      later->push_back(t);
      continue;
    }
    const std::span<Entry> entries = all.subspan(t.first, t.count);
    const Bounds bounds = bounds_of(entries);
    const auto left = uint32_t(part(entries, bounds, t.depth, most_in_leaf));
    if (left == 0) {
      set_child(nodes[t.node], t.side, bounds.box, ChildRef::leaf(t.first, t.count));
      continue;
    }
    const auto own = uint32_t(nodes.size());
    nodes.emplace_back();
    set_child(nodes[t.node], t.side, bounds.box, own);
    todo.push_back({t.first + left, t.count - left, own, 1, t.depth + 1});
    todo.push_back({t.first, left, own, 0, t.depth + 1});
  }
}

/// References to nodes of a subtree, which come to lie behind `offset` others. Its node 0 stands
/// for the one above it.
void append_subtree(const Task& task, const std::vector<BinaryNode>& subtree,
                    std::vector<BinaryNode>& nodes) {
  const auto offset = uint32_t(nodes.size()) - 1;
  const auto moved = [&](uint32_t ref) { return ChildRef::is_leaf(ref) ? ref : ref + offset; };
  const BinaryNode& above = subtree[0];
  set_child(nodes[task.node], task.side, {above.lower0, above.upper0}, moved(above.child0));
  for (size_t i = 1; i < subtree.size(); ++i) {
    nodes.push_back(subtree[i]);
    nodes.back().child0 = moved(subtree[i].child0), nodes.back().child1 = moved(subtree[i].child1);
  }
}

}  // namespace

void add_triangles(const scene::Mesh& mesh, const Mat34& world_from_object, uint32_t first,
                   std::vector<DeviceTriangle>& out) {
  const uint32_t mirrored = determinant(world_from_object) < 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.other_side.empty() && mesh.other_side[t] < t) continue;
    const auto corner = [&](size_t k) {
      return transform_point(world_from_object, mesh.positions[mesh.triangles[t][k]]);
    };
    out.push_back({corner(0), first + t, corner(1), mirrored, corner(2)});
  }
}

BinaryHierarchy sort_into_hierarchy(std::vector<DeviceTriangle> triangles, uint32_t most_in_leaf) {
  LUXEL_CHECK(triangles.size() < ChildRef::kFirstMask);
  LUXEL_CHECK(most_in_leaf >= 1 && most_in_leaf <= ChildRef::kMaxCount);
  BinaryHierarchy out;
  out.nodes.emplace_back();
  const auto n = uint32_t(triangles.size());
  if (n == 0) return out;
  std::vector<Entry> entries(n);
  parallel_for(n, 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const DeviceTriangle& t = triangles[i];
      for (const Vec3 p : {t.a, t.b, t.c}) entries[i].box.extend(p);
      entries[i].triangle = uint32_t(i);
    }
  });
  // The upper levels, then all that hangs on them side by side. The whole is the root's first
  // child: its second has no triangle.
  std::vector<Task> later;
  build(entries, {0, n, 0, 0, 1}, most_in_leaf, out.nodes, &later);
  std::vector<std::vector<BinaryNode>> subtrees(later.size());
  parallel_for(later.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      subtrees[k].emplace_back();
      build(entries, {later[k].first, later[k].count, 0, 0, later[k].depth}, most_in_leaf,
            subtrees[k], nullptr);
    }
  });
  for (size_t k = 0; k < later.size(); ++k) append_subtree(later[k], subtrees[k], out.nodes);
  out.triangles.resize(n);
  parallel_for(n, 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out.triangles[i] = triangles[entries[i].triangle];
  });
  return out;
}

}  // namespace luxel::trace
