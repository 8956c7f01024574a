#include "luxel/solve/matrix/transfer.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

struct Points {
  std::vector<Vec3> position, normal;
  void add(Vec3 p, Vec3 n) { position.push_back(p), normal.push_back(n); }
  size_t size() const { return position.size(); }
};

Transfer made(const Cut& cut, const Points& at) {
  Progress progress;
  auto out = make_transfer(cut.patched, cut.tracer, {at.position, at.normal}, progress);
  EXPECT_TRUE(out);
  return out ? std::move(*out) : Transfer{};
}

std::vector<Rgb> light_at(const Cut& cut, const Points& at, std::span<const Rgb> of_patch) {
  std::vector<Rgb> out(at.size());
  transfer(made(cut, at), of_patch, out);
  return out;
}

/// n x n places on the floor [x0, x1] x [z0, z1].
Points floor_grid(int n, std::array<float, 4> sides) {
  Points at;
  const auto [x0, x1, z0, z1] = sides;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k)
      at.add({x0 + (x1 - x0) * (float(i) + 0.5f) / float(n), 0,
              z0 + (z1 - z0) * (float(k) + 0.5f) / float(n)},
             {0, 1, 0});
  return at;
}

/// Every third point that patches are made of.
Points points_of(const Cut& cut) {
  Points at;
  for (size_t k = 0; k < cut.patches().points.size(); k += 3)
    at.add(cut.patches().points[k].position, cut.patches().points[k].normal);
  return at;
}

TEST(Transfer, WeightsSumToOne) {
  for (const scene::Scene& scene :
       {scene::cornell_box(), scene::spheres_and_cube(), testing::floor_with_wall()}) {
    const Cut cut(scene, 400);
    const Points at = points_of(cut);
    const Transfer map = made(cut, at);
    ASSERT_EQ(map.size(), at.size());
    for (size_t i = 0; i < map.size(); ++i) {
      double sum = 0;
      for (uint32_t k = map.first[i]; k < map.first[i + 1]; ++k) sum += double(map.weight[k]);
      ASSERT_NEAR(sum, 1, 1e-5) << scene.name << " " << i;  // of some twelve floats of either sign
    }
  }
}

TEST(Transfer, ConstantLightStays) {
  const Cut cut(scene::cornell_box(), 400);
  const std::vector<Rgb> even(cut.size(), Rgb{3, 2, 0.25f});
  for (const Rgb& e : light_at(cut, points_of(cut), even))
    EXPECT_LT(length(e - Rgb{3, 2, 0.25f}), 1e-4f);  // weights sum to 1 within 1e-5
}

TEST(Transfer, LinearLightIsKept) {
  // The light of a patch is that at its centroid, so a plane through centroids is the light itself.
  // The fit holds slopes back by 2 %: that leaves 0.02 of the mean offset of the patches in reach
  // from a place, some hundredths of a voxel in the middle of the floor. At its rim, where all
  // centroids lie on one side, less is lost than by taking the nearest patch: half a voxel.
  const Cut cut(testing::plate(), 1000);
  const auto linear = [](Vec3 p) { return Rgb{p.x, p.z, 0.5f + 0.3f * p.x - 0.2f * p.z}; };
  std::vector<Rgb> of_patch;
  for (const Vec3& p : cut.patches().centroid) of_patch.push_back(linear(p));
  const auto largest = [&](const Points& at) {
    const std::vector<Rgb> e = light_at(cut, at, of_patch);
    float error = 0;
    for (size_t i = 0; i < at.size(); ++i)
      error = std::max(error, length(e[i] - linear(at.position[i])));
    return error;
  };
  EXPECT_LT(largest(floor_grid(40, {0.1f, 0.9f, 0.1f, 0.9f})), 1e-3f);
  EXPECT_LT(largest(floor_grid(80, {0, 1, 0, 1})), 0.5f * cut.patches().voxel_m);
}

TEST(Transfer, NothingLeaksThroughAWall) {
  for (const size_t count : {100u, 400u, 1600u}) {
    const Cut cut(testing::floor_with_wall(), count);
    std::vector<Rgb> of_patch;
    for (const Vec3& p : cut.patches().centroid) of_patch.push_back(p.x < 0 ? Rgb{1, 1, 1} : Rgb{});
    Points at;
    for (int k = 0; k < 200; ++k)
      for (const float side : {-1.0f, 1.0f}) {
        const float z = (float(k) + 0.5f) / 200;
        for (const float gap : {1e-4f, 0.01f, 0.05f})
          at.add({side * (testing::kWallHalf_m + gap), 0, z}, {0, 1, 0});
        at.add({side * testing::kWallHalf_m, 0.25f, z}, {side, 0, 0});
      }
    const std::vector<Rgb> e = light_at(cut, at, of_patch);
    for (size_t i = 0; i < at.size(); ++i)
      EXPECT_NEAR(e[i].x, at.position[i].x < 0 ? 1 : 0, 0.05)
          << count << " patches, x " << at.position[i].x << ", y " << at.position[i].y << ", z "
          << at.position[i].z;
  }
}

TEST(Transfer, NothingPassesRoundAnEdge) {
  // The walls of a room have light of their own, up to the very edge.
  const Cut cut(scene::furnace_box({0.5f, 0.5f, 0.5f}, {}), 600);
  std::vector<Rgb> of_patch;
  for (const Vec3& n : cut.patches().elements.normal)
    of_patch.push_back(n.y > 0.9f ? Rgb{1, 1, 1} : Rgb{});
  const Points at = floor_grid(60, {1e-4f, 1 - 1e-4f, 1e-4f, 1 - 1e-4f});
  for (const Rgb& e : light_at(cut, at, of_patch)) EXPECT_NEAR(e.x, 1, 1e-4);
}

TEST(Transfer, LightIsNeverNegative) {
  // One bright patch: planes through it fall below nothing beside it.
  const Cut cut(scene::cornell_box(), 400);
  const Points at = points_of(cut);
  const Transfer map = made(cut, at);
  EXPECT_LT(*std::min_element(map.weight.begin(), map.weight.end()), 0);
  std::vector<Rgb> of_place(at.size());
  for (size_t lit = 0; lit < cut.size(); lit += 7) {
    std::vector<Rgb> of_patch(cut.size());
    of_patch[lit] = {100, 100, 100};
    transfer(map, of_patch, of_place);
    for (const Rgb& e : of_place) ASSERT_GE(min_component(e), 0);
  }
}

TEST(Transfer, TakesTheNearestWhereNoneIsInSight) {
  // Just under the floor: the floor itself hides all of its patches.
  const Cut cut(testing::plate(), 100);
  Points at;
  at.add({0.5f, -0.5f * cut.patches().voxel_m, 0.5f}, {0, 1, 0});
  const Transfer map = made(cut, at);
  ASSERT_EQ(map.weight.size(), 1u);
  EXPECT_EQ(map.weight[0], 1);
  for (const Vec3& c : cut.patches().centroid)
    EXPECT_GE(length(c - at.position[0]),
              length(cut.patches().centroid[map.patch[0]] - at.position[0]));
}

TEST(Transfer, SameBitsForAnyNumberOfThreads) {
  const Cut cut(scene::cornell_box(), 400);
  const Points at = points_of(cut);
  const auto map = [&](int threads) {
    const ThreadLimit limit(threads);
    return made(cut, at);
  };
  const Transfer one = map(1);
  for (const int threads : {2, 7}) {
    const Transfer other = map(threads);
    EXPECT_EQ(one.first, other.first);
    EXPECT_EQ(one.patch, other.patch);
    EXPECT_EQ(one.weight, other.weight);
  }
}

TEST(Transfer, CanBeCancelled) {
  const Cut cut(testing::plate(), 50);
  const Points at = floor_grid(4, {0, 1, 0, 1});
  Progress progress;
  progress.request_cancel();
  const auto map = make_transfer(cut.patched, cut.tracer, {at.position, at.normal}, progress);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::matrix
