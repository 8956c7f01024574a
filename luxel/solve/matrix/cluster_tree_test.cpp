#include "luxel/solve/matrix/cluster_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

/// Expects what is true of any tree over `count` patches.
void expect_tree(const ClusterTree& tree, uint32_t count, uint32_t leaf_size) {
  ASSERT_FALSE(tree.clusters.empty());
  EXPECT_EQ(std::set<uint32_t>(tree.order.begin(), tree.order.end()).size(), count);
  EXPECT_EQ(tree.order.size(), count);
  EXPECT_EQ(tree.clusters[0].first, 0u);
  EXPECT_EQ(tree.clusters[0].end, count);
  EXPECT_EQ(tree.clusters[0].depth, 0u);
  std::vector<int> leaves_of(count), parents_of(tree.clusters.size());
  for (uint32_t c = 0; c < tree.clusters.size(); ++c) {
    const Cluster& whole = tree.clusters[c];
    if (whole.is_leaf()) {
      EXPECT_LE(whole.size(), leaf_size);
      for (uint32_t k = whole.first; k < whole.end; ++k) ++leaves_of[k];
      continue;
    }
    ASSERT_GT(whole.child, c);
    ASSERT_LT(whole.child + 1, tree.clusters.size());
    const Cluster& a = tree.clusters[whole.child];
    const Cluster& b = tree.clusters[whole.child + 1];
    EXPECT_TRUE(a.first == whole.first && a.end == b.first && b.end == whole.end);
    EXPECT_TRUE(a.size() > 0 && b.size() > 0);
    EXPECT_TRUE(a.depth == whole.depth + 1 && b.depth == whole.depth + 1);
    ++parents_of[whole.child], ++parents_of[whole.child + 1];
  }
  EXPECT_EQ(std::count(leaves_of.begin(), leaves_of.end(), 1), count);
  EXPECT_EQ(std::count(parents_of.begin() + 1, parents_of.end(), 1),
            std::ptrdiff_t(tree.clusters.size()) - 1);
}

std::vector<Vec3> random_points(size_t count, uint64_t seed) {
  return testing::random_light(count, seed);
}

std::vector<Vec3> random_directions(size_t count, uint64_t seed) {
  std::vector<Vec3> out = random_points(count, seed);
  for (Vec3& d : out) d = normalize(d - Vec3{0.5f, 0.5f, 0.5f});
  return out;
}

TEST(ClusterTree, HasEveryPatchInOneLeaf) {
  for (const uint32_t count : {1u, 7u, 8u, 9u, 1000u})
    for (const uint32_t leaf : {1u, 3u, 8u}) {
      SCOPED_TRACE(::testing::Message() << count << " patches, leaves of " << leaf);
      expect_tree(make_cluster_tree(random_points(count, 1), random_directions(count, 2), leaf),
                  count, leaf);
    }
}

TEST(ClusterTree, EndsWherePatchesAreAlike) {
  const std::vector<Vec3> same(100, Vec3{1, 2, 3}), up(100, Vec3{0, 1, 0});
  expect_tree(make_cluster_tree(same, up, 8), 100, 8);
  expect_tree(make_cluster_tree(same, random_directions(100, 3), 1), 100, 1);
  expect_tree(make_cluster_tree(random_points(100, 4), up, 1), 100, 1);
}

TEST(ClusterTree, EndsWhereOnePatchIsFarFromTheRest) {
  // Places that halve their distance to a corner: halving boxes would take one patch at a time.
  std::vector<Vec3> position;
  for (int k = 0; k < 100; ++k) position.push_back(Vec3{1, 1, 1} * std::ldexp(1.0f, -k));
  const ClusterTree tree = make_cluster_tree(position, std::vector<Vec3>(100, Vec3{0, 1, 0}), 1);
  expect_tree(tree, 100, 1);
  uint32_t depth = 0;
  for (const Cluster& c : tree.clusters) depth = std::max(depth, c.depth);
  // Each half has 4/5 or less of its whole: log(100) / log(5 / 4) = 20.6, and one for rounding.
  EXPECT_LE(depth, 22u);
}

TEST(ClusterTree, TellsTheSidesOfAWallApartFirst) {
  // Two coinciding squares, back to back: the halves of all face one way each.
  std::vector<Vec3> position = random_points(64, 5), normal(64);
  for (size_t k = 0; k < 64; ++k) position[k].y = 0, normal[k] = {0, k % 2 ? 1.0f : -1.0f, 0};
  const ClusterTree tree = make_cluster_tree(position, normal, 8);
  for (uint32_t half = 1; half <= 2; ++half) {
    std::set<float> sides;
    for (uint32_t k = tree.clusters[half].first; k < tree.clusters[half].end; ++k)
      sides.insert(normal[tree.order[k]].y);
    EXPECT_EQ(sides.size(), 1u);
  }
}

}  // namespace
}  // namespace luxel::matrix
