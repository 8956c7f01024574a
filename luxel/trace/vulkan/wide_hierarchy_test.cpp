#include "luxel/trace/vulkan/wide_hierarchy.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "luxel/base/random.h"

namespace luxel::trace {
namespace {

std::vector<DeviceTriangle> flat_and_scattered(size_t count) {
  RandomStream random{9};
  const auto place = [&] { return Vec3{random.next(), random.next(), random.next()}; };
  std::vector<DeviceTriangle> out;
  for (uint32_t i = 0; i < count; ++i) {
    const float height = i % 3 ? 4 * random.next() : 0;  // a third lies in one plane
    const Vec3 at{100 + 10 * random.next(), height, 10 * random.next()};
    const Vec3 flat = i % 3 ? Vec3{1, 1, 1} : Vec3{1, 0, 1};
    out.push_back({at, i, at + place() * flat, 0, at + place() * flat, 0});
  }
  return out;
}

Box3 box_of(const WideNode& node, size_t slot) {
  const auto unit = [&](size_t axis) { return std::ldexp(1.0f, int(node.exponent[axis]) - 127); };
  const Vec3 units{unit(0), unit(1), unit(2)};
  const auto whole = [&](uint8_t x, uint8_t y, uint8_t z) {
    return node.origin + units * Vec3{float(x), float(y), float(z)};
  };
  return {whole(node.lower_x[slot], node.lower_y[slot], node.lower_z[slot]),
          whole(node.upper_x[slot], node.upper_y[slot], node.upper_z[slot])};
}

bool holds(const Box3& box, Vec3 p) {
  return p.x >= box.lower.x && p.y >= box.lower.y && p.z >= box.lower.z && p.x <= box.upper.x &&
         p.y <= box.upper.y && p.z <= box.upper.z;
}

/// Counts the triangles below a node, and sees that all boxes on the way to them hold them.
void walk(const WideHierarchy& h, uint32_t number, std::vector<Box3>& around,
          std::vector<int>& times_found) {
  const WideNode& node = h.nodes[number];
  for (size_t slot = 0; slot < 8; ++slot) {
    if (node.meta[slot] == 0) continue;
    around.push_back(box_of(node, slot));
    if (node.inner >> slot & 1) {
      EXPECT_EQ(node.meta[slot], WideNode::kInner + slot);
      const unsigned before = node.inner & ((1u << slot) - 1);
      walk(h, node.first_node + uint32_t(std::popcount(before)), around, times_found);
    } else {
      const auto count = uint32_t(std::popcount(unsigned(node.meta[slot] >> 5)));
      for (uint32_t k = 0; k < count; ++k) {
        const DeviceTriangle& t = h.triangles[node.first_triangle + (node.meta[slot] & 31u) + k];
        ++times_found[t.number];
        for (const Box3& box : around)
          for (const Vec3 p : {t.a, t.b, t.c}) EXPECT_TRUE(holds(box, p));
      }
    }
    around.pop_back();
  }
}

/// A little more than where the triangles of these tests lie.
constexpr float kReach = 50;

TEST(WideHierarchy, HoldsEachTriangleOnceInBoxesAroundIt) {
  for (const size_t count : {0, 1, 2, 9, 3000}) {
    const WideHierarchy h =
        widen(sort_into_hierarchy(flat_and_scattered(count), WideNode::kMostInLeaf), kReach);
    std::vector<int> times_found(count);
    std::vector<Box3> around;
    walk(h, 0, around, times_found);
    for (const int times : times_found) EXPECT_EQ(times, 1);
  }
}

// Two triangles on the x axis: the one towards +x lies in a slot with bit 2, the other in one
// without it.
TEST(WideHierarchy, HasChildrenInTheSlotsOfTheirDirections) {
  std::vector<DeviceTriangle> two;
  for (uint32_t i = 0; i < 2; ++i) {
    const float x = 10.0f * float(i);
    two.push_back({{x, 0, 0}, i, {x + 1, 0, 0}, 0, {x, 1, 0}, 0});
  }
  const WideHierarchy h = widen(sort_into_hierarchy(two, 1), kReach);
  ASSERT_EQ(h.nodes.size(), 1u);
  for (size_t slot = 0; slot < 8; ++slot) {
    if (h.nodes[0].meta[slot] == 0) continue;
    const Box3 box = box_of(h.nodes[0], slot);
    EXPECT_EQ((slot & 4) != 0, box.centre().x > 5) << slot;
  }
}

}  // namespace
}  // namespace luxel::trace
