#include "luxel/trace/vulkan/binary_hierarchy.h"

#include <gtest/gtest.h>

#include <cstring>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::trace {
namespace {

std::vector<DeviceTriangle> scattered(size_t count) {
  RandomStream random{3};
  const auto place = [&] { return Vec3{random.next(), random.next(), random.next()}; };
  std::vector<DeviceTriangle> out;
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3 at = place() * 10.0f;
    out.push_back({at + place() * 0.1f, i, at + place() * 0.1f, 0, at + place() * 0.1f, 0});
  }
  return out;
}

bool holds(Vec3 lower, Vec3 upper, Vec3 p) {
  return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x && p.y <= upper.y &&
         p.z <= upper.z;
}

/// Walks a child, sees that its box holds all triangles below, counts each, and returns the depth.
int walk(const BinaryHierarchy& h, uint32_t ref, Vec3 lower, Vec3 upper,
         std::vector<int>& times_found) {
  if (ChildRef::is_leaf(ref)) {
    for (uint32_t k = 0; k < ChildRef::count(ref); ++k) {
      const DeviceTriangle& t = h.triangles[ChildRef::first(ref) + k];
      ++times_found[t.number];
      for (const Vec3 p : {t.a, t.b, t.c}) EXPECT_TRUE(holds(lower, upper, p));
    }
    return 0;
  }
  const BinaryNode& node = h.nodes[ref];
  if (ref != 0) {
    for (const Vec3 p : {node.lower0, node.upper0, node.lower1, node.upper1})
      EXPECT_TRUE(holds(lower, upper, p));
    for (const uint32_t child : {node.child0, node.child1})
      EXPECT_TRUE(!ChildRef::is_leaf(child) || ChildRef::count(child) > 0);
  }
  return 1 + std::max(walk(h, node.child0, node.lower0, node.upper0, times_found),
                      walk(h, node.child1, node.lower1, node.upper1, times_found));
}

int depth_of(const BinaryHierarchy& h, size_t triangles) {
  std::vector<int> times_found(triangles);
  const Vec3 all{1e9f, 1e9f, 1e9f};
  const int depth = walk(h, 0, -all, all, times_found);
  for (const int times : times_found) EXPECT_EQ(times, 1);
  return depth;
}

TEST(BinaryHierarchy, HoldsEachTriangleOnceInBoxesAroundIt) {
  for (const size_t count : {0, 1, 2, 5, 100, 40000}) {
    const BinaryHierarchy h = sort_into_hierarchy(scattered(count));
    EXPECT_EQ(h.triangles.size(), count);
    EXPECT_LE(depth_of(h, count), 40);
  }
}

// Triangles in one place, and triangles each 0.97 of the last, which the heuristic peels off one by
// one: no path is longer than the stacks of devices.
TEST(BinaryHierarchy, IsNeverDeeperThanAStack) {
  std::vector<DeviceTriangle> same(3000, DeviceTriangle{{0, 0, 0}, 0, {1, 0, 0}, 0, {0, 1, 0}, 0});
  std::vector<DeviceTriangle> peeled;
  for (uint32_t i = 0; i < same.size(); ++i) same[i].number = i;
  for (uint32_t i = 0; i < 3000; ++i) {
    const float x = std::pow(0.97f, float(i % 2000)), size = 0.01f * x;
    peeled.push_back({{x, 0, 0}, i, {x + size, 0, 0}, 0, {x, size, 0}, 0});
  }
  EXPECT_LE(depth_of(sort_into_hierarchy(same), 3000), kMaxHierarchyDepth);
  EXPECT_LE(depth_of(sort_into_hierarchy(peeled), 3000), kMaxHierarchyDepth);
}

TEST(BinaryHierarchy, HasTheSameBitsForAnyNumberOfThreads) {
  const auto with = [](int threads) {
    const ThreadLimit limit(threads);
    return sort_into_hierarchy(scattered(60000));
  };
  const BinaryHierarchy one = with(1), four = with(4);
  ASSERT_EQ(one.nodes.size(), four.nodes.size());
  EXPECT_EQ(std::memcmp(one.nodes.data(), four.nodes.data(), one.nodes.size() * sizeof(BinaryNode)),
            0);
  EXPECT_EQ(std::memcmp(one.triangles.data(), four.triangles.data(),
                        one.triangles.size() * sizeof(DeviceTriangle)),
            0);
}

}  // namespace
}  // namespace luxel::trace
