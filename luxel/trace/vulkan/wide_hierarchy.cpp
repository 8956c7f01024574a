#include "luxel/trace/vulkan/wide_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "luxel/base/check.h"

namespace luxel::trace {
namespace {

constexpr size_t kSlots = 8;

struct Child {
  Box3 box;
  uint32_t ref = 0;  ///< into the binary hierarchy
};

float half_area(const Box3& b) {
  const Vec3 d = b.upper - b.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

void add_children(const BinaryNode& node, std::vector<Child>& out) {
  for (const Child& c : {Child{{node.lower0, node.upper0}, node.child0},
                         Child{{node.lower1, node.upper1}, node.child1}})
    if (!ChildRef::is_leaf(c.ref) || ChildRef::count(c.ref) > 0) out.push_back(c);
}

/// Up to eight children of the node, whose boxes hold all of it.
std::vector<Child> children_of(const BinaryHierarchy& binary, uint32_t node) {
  std::vector<Child> out;
  add_children(binary.nodes[node], out);
  while (out.size() < kSlots) {
    size_t largest = out.size();
    for (size_t i = 0; i < out.size(); ++i)
      if (!ChildRef::is_leaf(out[i].ref) &&
          (largest == out.size() || half_area(out[i].box) > half_area(out[largest].box)))
        largest = i;
    if (largest == out.size()) break;
    const uint32_t ref = out[largest].ref;
    out.erase(out.begin() + std::ptrdiff_t(largest));
    add_children(binary.nodes[ref], out);
  }
  return out;
}

/// Per slot the child in it, kSlots: none. The child that lies farthest towards a slot's corner
/// gets it, the clearest choice first.
std::array<size_t, kSlots> slots_of(std::span<const Child> children, Vec3 middle) {
  std::array<size_t, kSlots> out;
  out.fill(kSlots);
  std::array<bool, kSlots> has_slot{};
  for (size_t round = 0; round < children.size(); ++round) {
    float best = -INFINITY;
    size_t best_child = kSlots, best_slot = 0;
    for (size_t c = 0; c < children.size(); ++c) {
      if (has_slot[c]) continue;
      const Vec3 d = children[c].box.centre() - middle;
      for (size_t s = 0; s < kSlots; ++s) {
        if (out[s] != kSlots) continue;
        const float towards = (s & 4 ? d.x : -d.x) + (s & 2 ? d.y : -d.y) + (s & 1 ? d.z : -d.z);
        if (best_child == kSlots || towards > best) best = towards, best_child = c, best_slot = s;
      }
    }
    out[best_slot] = best_child, has_slot[best_child] = true;
  }
  return out;
}

/// A power of two of which 255 span `extent`, less than four times too large; + 127.
uint8_t exponent_for(float extent) {
  int e = 0;
  std::frexp(std::max(extent, 1e-30f) / 255, &e);  // < 2^e
  return uint8_t(std::clamp(e + 127, 1, 254));
}

/// The parts of a box along one axis, in units from the origin, rounded outwards.
struct Steps {
  uint8_t lower, upper;
};
Steps steps_of(float lower, float upper, float origin, uint8_t exponent) {
  const double unit = std::ldexp(1.0, int(exponent) - 127);
  const auto whole = [](double x) { return uint8_t(std::clamp(x, 0.0, 255.0)); };
  return {whole(std::floor((double(lower) - double(origin)) / unit)),
          whole(std::ceil((double(upper) - double(origin)) / unit))};
}

/// Makes wide nodes one after the other, the root first.
struct Maker {
  const BinaryHierarchy& binary;
  float margin_m;  ///< by which boxes grow
  WideHierarchy out{};
  std::deque<uint32_t> todo{};  ///< binary nodes of the wide ones to come, in their order

  /// Appends a node and the triangles of its leaves; its inner children go to the end of `todo`.
  void make(uint32_t binary_node);
  void set_box(WideNode& node, size_t slot, const Box3& box) const;
  void set_leaf(WideNode& node, size_t slot, uint32_t ref);
};

void Maker::set_box(WideNode& node, size_t slot, const Box3& box) const {
  const Steps x = steps_of(box.lower.x, box.upper.x, node.origin.x, node.exponent[0]),
              y = steps_of(box.lower.y, box.upper.y, node.origin.y, node.exponent[1]),
              z = steps_of(box.lower.z, box.upper.z, node.origin.z, node.exponent[2]);
  node.lower_x[slot] = x.lower, node.lower_y[slot] = y.lower, node.lower_z[slot] = z.lower;
  node.upper_x[slot] = x.upper, node.upper_y[slot] = y.upper, node.upper_z[slot] = z.upper;
}

void Maker::set_leaf(WideNode& node, size_t slot, uint32_t ref) {
  const uint32_t count = ChildRef::count(ref), first = ChildRef::first(ref);
  LUXEL_CHECK(count <= WideNode::kMostInLeaf);
  const size_t place = out.triangles.size() - node.first_triangle;
  node.meta[slot] = uint8_t(((1u << count) - 1) << 5 | place);
  for (uint32_t k = 0; k < count; ++k) out.triangles.push_back(binary.triangles[first + k]);
}

void Maker::make(uint32_t binary_node) {
  std::vector<Child> children = children_of(binary, binary_node);
  WideNode node;
  node.first_node = uint32_t(out.nodes.size() + 1 + todo.size());
  node.first_triangle = uint32_t(out.triangles.size());
  Box3 all;
  for (Child& c : children) {
    const Vec3 margin{margin_m, margin_m, margin_m};
    c.box = {c.box.lower - margin, c.box.upper + margin};
    all.lower = min(all.lower, c.box.lower), all.upper = max(all.upper, c.box.upper);
  }
  if (!children.empty()) {
    const Vec3 extent = all.upper - all.lower;
    node.origin = all.lower;
    node.exponent = {exponent_for(extent.x), exponent_for(extent.y), exponent_for(extent.z)};
  }
  const std::array<size_t, kSlots> slots = slots_of(children, all.centre());
  for (size_t s = 0; s < kSlots; ++s) {
    if (slots[s] == kSlots) continue;
    const Child& c = children[slots[s]];
    set_box(node, s, c.box);
    if (ChildRef::is_leaf(c.ref)) {
      set_leaf(node, s, c.ref);
    } else {
      node.meta[s] = uint8_t(WideNode::kInner + s), node.inner |= uint8_t(1u << s);
      todo.push_back(c.ref);
    }
  }
  out.nodes.push_back(node);
}

}  // namespace

float reach_of(const Box3& box) {
  return box.diagonal() + std::max(max_component(max(box.lower, -box.lower)),
                                   max_component(max(box.upper, -box.upper)));
}

WideHierarchy widen(const BinaryHierarchy& binary, float reach) {
  Maker maker{binary, 0x1p-20f * reach};
  maker.out.nodes.reserve(binary.nodes.size() / 4 + 1);
  maker.out.triangles.reserve(binary.triangles.size());
  maker.make(0);
  while (!maker.todo.empty()) {
    const uint32_t next = maker.todo.front();
    maker.todo.pop_front();
    maker.make(next);
  }
  return std::move(maker.out);
}

}  // namespace luxel::trace
