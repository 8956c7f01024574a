#include "luxel/base/random.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "luxel/base/sobol_eighths.h"

namespace luxel {
namespace {

// A (0, m, 2)-net in base 2 puts exactly one of its 2^m points into each elementary interval of
// area 2^-m, whatever the interval's shape. Owen scrambling keeps this property.
TEST(SobolOwen2d, EveryAlignedBlockIsANetForEverySeed) {
  for (const uint64_t seed : {0ull, 1ull, 0x123456789abcdefull})
    for (const int m : {4, 6, 8})
      for (const uint32_t block : {0u, 3u})
        for (int columns_log2 = 0; columns_log2 <= m; ++columns_log2) {
          std::set<std::pair<int, int>> cells;
          for (uint32_t i = 0; i < (1u << m); ++i) {
            const Vec2 p = sobol_owen_2d((block << m) + i, seed);
            cells.insert(
                {int(p.x * float(1 << columns_log2)), int(p.y * float(1 << (m - columns_log2)))});
          }
          EXPECT_EQ(cells.size(), size_t(1) << m) << "seed " << seed << " 2^" << m;
        }
}

TEST(SobolOwen2d, ManyAtOnceAreTheSamePoints) {
  for (const size_t count : {1, 7, 64, 1000}) {
    std::vector<float> x(count), y(count);
    sobol_owen_2d_points(0x1234567890abcdef, x, y);
    for (size_t i = 0; i < count; ++i)
      ASSERT_EQ((Vec2{x[i], y[i]}), sobol_owen_2d(uint32_t(i), 0x1234567890abcdef)) << i;
    sobol_owen_2d_points(0x1234567890abcdef, x, y, 300);
    for (size_t i = 0; i < count; ++i)
      ASSERT_EQ((Vec2{x[i], y[i]}), sobol_owen_2d(300 + uint32_t(i), 0x1234567890abcdef)) << i;
  }
}

TEST(SobolOwen2d, ThoseOfSomeIndicesAreTheSamePoints) {
  const std::vector<uint32_t> indices{0, 3, 1, 255, 70000, 4000000000u, 12, 12, 5};
  std::vector<float> x(indices.size()), y(indices.size());
  sobol_owen_2d_points(0x1234567890abcdef, indices, x, y);
  for (size_t i = 0; i < indices.size(); ++i)
    EXPECT_EQ((Vec2{x[i], y[i]}), sobol_owen_2d(indices[i], 0x1234567890abcdef)) << indices[i];
}

TEST(SobolOwen2d, LiesInTheEighthsThatAreSaid) {
  for (const uint64_t seed : {0ull, 7ull, 0x1234567890abcdefull, 0xfedcba9876543210ull}) {
    const SobolEighths to = sobol_owen_eighths(seed);
    for (uint32_t k = 0; k < 3000; ++k) {
      const uint32_t index = k < 2000 ? k : uint32_t(hash64(k));
      const Vec2 p = sobol_owen_2d(index, seed);
      const SobolEighth plain = sobol_eighth(index);
      ASSERT_EQ(int(to.x[plain.x]), int(p.x * 8)) << index;
      ASSERT_EQ(int(to.y[plain.y]), int(p.y * 8)) << index;
    }
  }
}

TEST(SobolOwen2d, HasOnePointOfABlockInEachOf64Parts) {
  for (const uint32_t block : {0u, 1u, 2u, 77u, 1023u, 130000u})
    for (uint32_t x = 0; x < 8; ++x)
      for (uint32_t y = 0; y < 8; ++y) {
        const uint32_t index = both::sample_of_eighths(block, x, y);
        ASSERT_EQ(index / 64, block);
        const SobolEighth at = sobol_eighth(index);
        ASSERT_EQ(at.x, x);
        ASSERT_EQ(at.y, y);
      }
}

TEST(SobolOwen2d, SeedsGiveDifferentPoints) {
  EXPECT_NE(sobol_owen_2d(1, 1).x, sobol_owen_2d(1, 2).x);
  EXPECT_NE(sobol_owen_2d(1, 1).y, sobol_owen_2d(1, 2ull << 32).y);
}

// The mean of one scrambled point over seeds is that of a uniform variable: 1/2 with a standard
// error of 1 / sqrt(12 n). Six of those bound the chance of a false alarm to 2e-9.
TEST(SobolOwen2d, EachPointIsUniformOverSeeds) {
  const int n = 1 << 14;
  for (const uint32_t index : {0u, 1u, 77u}) {
    double sum_x = 0, sum_y = 0;
    for (int s = 0; s < n; ++s) {
      const Vec2 p = sobol_owen_2d(index, hash64(uint64_t(s)));
      sum_x += p.x, sum_y += p.y;
    }
    const double bound = 6 / std::sqrt(12.0 * n);
    EXPECT_NEAR(sum_x / n, 0.5, bound);
    EXPECT_NEAR(sum_y / n, 0.5, bound);
  }
}

}  // namespace
}  // namespace luxel
