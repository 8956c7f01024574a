#include "luxel/solve/gather/rays/element_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/warp.h"

namespace luxel::gather {
namespace {

constexpr Samples kRanges[] = {{32, 200}, {0, 1}, {5, 5}, {0, 256}, {100, 1124}, {0, 65535}};

/// The number, in Morton order, of the cell in which a point lies.
size_t cell_of(Vec2 p) {
  const auto x = size_t(p.x * kCellsPerAxis), y = size_t(p.y * kCellsPerAxis);
  size_t out = 0;
  for (size_t bit = 0; bit < 3; ++bit)
    out |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
  return out;
}

// With one batch for all, as tiles have it.
TEST(ElementRays, AreOnePerSampleInTheCellsOfTheirPoints) {
  RayBatch batch;
  for (const uint64_t seed : {1ull, 0xfedcba9876543210ull})
    for (const Samples samples : kRanges) {
      fill_samples(seed, samples, batch);
      for (uint32_t k = 0; k < samples.count(); ++k)
        ASSERT_EQ(batch.cell_of(k), cell_of(sobol_owen_2d(batch.sample[k], seed))) << k;
      std::vector<uint32_t> all(samples.count()), sorted = batch.sample;
      std::iota(all.begin(), all.end(), samples.first);
      std::ranges::sort(sorted);
      EXPECT_EQ(sorted, all);
    }
}

TEST(ElementRays, LieInTheirPointsDirections) {
  const Vec3 from{1, 2, 3}, normal = normalize(Vec3{1, -2, 0.5f});
  const Frame frame = frame_around(normal);
  RayBatch batch;
  fill_rays(from, normal, normal, 7, {32, 200}, batch);
  for (size_t k = 0; k < batch.rays.size(); ++k) {
    const Vec2 p = sobol_owen_2d(batch.sample[k], 7);
    const float r = std::sqrt(p.y), angle = 2 * kPi * p.x;
    const Vec3 local{r * std::cos(angle), r * std::sin(angle), std::sqrt(1 - p.y)};
    EXPECT_EQ(batch.rays[k].origin, from);
    // Rounding of sine, cosine and of the frame.
    EXPECT_LT(length(batch.rays[k].direction - frame.to_world(local)), 1e-5f);
  }
}

TEST(ElementRays, SomeAreThoseOfAll) {
  RandomStream random{14};
  RayBatch all, some;
  for (uint64_t k = 0; k < 50; ++k) {
    const Vec3 normal =
        normalize(Vec3{random.next(), random.next(), random.next()} - Vec3{0.5f, 0.5f, 0.5f});
    const Vec3 geometric = normalize(normal + Vec3{0.2f, 0.1f, -0.1f} * random.next());
    const Samples samples = kRanges[k % 5];
    const uint64_t seed = hash64(3, k), cells = hash64(4, k);
    fill_rays({}, normal, geometric, seed, samples, all);
    find_ray_cells(seed, samples, some);
    EXPECT_EQ(some.first_of_cell, all.first_of_cell);
    fill_samples_of(cells, some);
    std::vector<uint32_t> which;
    for (uint32_t r = 0; r < samples.count(); ++r)
      if (cells >> all.cell_of(r) & 1 && random.next() < 0.6f) which.push_back(r);
    fill_directions({}, normal, geometric, which, some);
    for (const uint32_t r : which) {
      EXPECT_EQ(some.sample[r], all.sample[r]);
      EXPECT_EQ(some.rays[r].direction, all.rays[r].direction);
    }
  }
}

}  // namespace
}  // namespace luxel::gather
