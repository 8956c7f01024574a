#include "luxel/post/refill.h"

#include <gtest/gtest.h>

namespace luxel::post {
namespace {

/// A row of texels; `charts` gives the chart of each.
struct Row {
  atlas::Atlas atlas;
  atlas::TexelMap map;
};

Row row_of(const std::vector<uint32_t>& charts) {
  Row row;
  const int n = int(charts.size());
  row.atlas.resolution = row.map.resolution = n;
  row.atlas.chart = charts;
  row.map.texel_at.assign(size_t(n) * size_t(n), atlas::kNone);
  for (uint32_t i = 0; i < charts.size(); ++i) {
    row.map.texels.push_back({uint16_t(i), 0, {}, i, true});
    row.map.texel_at[i] = i;
  }
  return row;
}

TEST(RefillHidden, GoesInwardsRingByRingAndLeavesTheRest) {
  const Row row = row_of({0, 0, 0, 0, 0, 0});
  const std::vector<uint8_t> hidden{0, 1, 1, 1, 1, 1};
  std::vector<Rgb> values(6);
  values[0] = {4, 2, 1};
  refill_hidden(row.atlas, row.map, hidden, 2, {}, values);
  EXPECT_EQ(values[0], (Rgb{4, 2, 1}));
  EXPECT_EQ(values[1], (Rgb{4, 2, 1}));
  EXPECT_EQ(values[2], (Rgb{4, 2, 1}));
  EXPECT_EQ(values[3], (Rgb{0, 0, 0}));
}

TEST(RefillHidden, FillsSeveralArraysFromTheSameTexels) {
  const Row row = row_of({0, 0, 0, 0});
  const std::vector<uint8_t> hidden{0, 1, 0, 1};
  std::vector<Rgb> a{{4, 2, 1}, {}, {2, 0, 1}, {}}, b{{0, 0, 0}, {9, 9, 9}, {1, 1, 1}, {}};
  const std::vector<std::span<Rgb>> arrays{a, b};
  EXPECT_EQ(refill_hidden(row.atlas, row.map, hidden, 1, {}, arrays),
            (std::vector<uint32_t>{1, 3}));
  EXPECT_EQ(a[1], (Rgb{3, 1, 1}));
  EXPECT_EQ(b[1], (Rgb{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(b[3], (Rgb{1, 1, 1}));
}

TEST(RefillHidden, TakesTheMeanOfBothSides) {
  const Row row = row_of({0, 0, 0});
  std::vector<Rgb> values{{1, 1, 1}, {9, 9, 9}, {3, 3, 3}};
  refill_hidden(row.atlas, row.map, std::vector<uint8_t>{0, 1, 0}, 1, {}, values);
  EXPECT_EQ(values[1], (Rgb{2, 2, 2}));
}

/// A texel under a wall belongs to one side of it: that of its nearest neighbour.
TEST(RefillHidden, StaysOnOneSideOfABarrier) {
  const Row row = row_of({0, 0, 0});
  std::vector<Rgb> values{{1, 1, 1}, {9, 9, 9}, {3, 3, 3}};
  const Parted parted = [](uint32_t a, uint32_t b) { return (a < 1) != (b < 1); };
  const auto filled =
      refill_hidden(row.atlas, row.map, std::vector<uint8_t>{0, 1, 0}, 1, parted, values);
  EXPECT_EQ(values[1], (Rgb{1, 1, 1}));
  EXPECT_EQ(filled, (std::vector<uint32_t>{1}));
}

TEST(RefillHidden, NeverMixesCharts) {
  const Row row = row_of({0, 1, 1});
  std::vector<Rgb> values{{5, 5, 5}, {0, 0, 0}, {0, 0, 0}};
  refill_hidden(row.atlas, row.map, std::vector<uint8_t>{0, 1, 1}, 2, {}, values);
  EXPECT_EQ(values[1], (Rgb{0, 0, 0}));
}

}  // namespace
}  // namespace luxel::post
