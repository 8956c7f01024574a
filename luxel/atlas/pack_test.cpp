#include "luxel/atlas/pack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "luxel/atlas/strip.h"
#include "luxel/base/random.h"

namespace luxel::atlas {
namespace {

using Cells = std::set<std::pair<int, int>>;  // (x, y)

Cells cells_of(const Mask& mask, ChartPosition at = {}) {
  Cells cells;
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.rows[size_t(j)])
      for (int i = run.begin; i < run.end; ++i) cells.emplace(at.x + i, at.y + j);
  return cells;
}

Mask mask_of(int width, int height, const Cells& cells) {
  Mask mask{width, height, std::vector<std::vector<Span>>(size_t(height)), cells.size()};
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (!cells.contains({i, j})) continue;
      auto& row = mask.rows[size_t(j)];
      if (!row.empty() && row.back().end == i)
        ++row.back().end;
      else
        row.push_back({i, i + 1});
    }
  return mask;
}

/// A blob with holes that touches all four sides of its rectangle.
Mask random_mask(int width, int height, RandomStream& random) {
  Cells cells{{0, 0}, {width - 1, height - 1}};
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      if (random.next() < 0.999f) cells.emplace(i, j);
  return mask_of(width, height, cells);
}

TEST(Pack, AQuarterTurnMovesEveryTexelAsItSays) {
  RandomStream random(1);
  const Mask mask = random_mask(9, 5, random);
  Cells expected;
  for (const auto& [i, j] : cells_of(mask)) expected.emplace(j, mask.width - 1 - i);
  const Mask once = turned(mask);
  EXPECT_EQ(once.width, 5);
  EXPECT_EQ(once.height, 9);
  EXPECT_EQ(once.texels, mask.texels);
  EXPECT_EQ(cells_of(once), expected);
  EXPECT_EQ(cells_of(turned(turned(turned(once)))), cells_of(mask));
}

using Grid = std::vector<std::vector<bool>>;  // [y][x], true: taken

/// The strip's search, texel by texel.
ChartPosition topmost_by_trying(const Grid& taken, const Mask& mask) {
  const Cells wanted = cells_of(mask);
  const int side = int(taken.size());
  for (int y = 0; y + mask.height <= side; ++y)
    for (int x = 0; x + mask.width <= side; ++x)
      if (std::none_of(wanted.begin(), wanted.end(),
                       [&](auto c) { return taken[size_t(y + c.second)][size_t(x + c.first)]; }))
        return {x, y};
  return {-1, -1};
}

/// A square, and the largest shapes to pack into it.
struct PackCase {
  int side, width, height;
};

/// Packs until nothing finds room; every place must be that of the plain search.
void pack_both_ways(const PackCase& c, uint64_t seed, int& placed) {
  const int side = c.side;
  RandomStream random(seed);
  Strip strip(side);
  Grid taken;
  taken.assign(size_t(side), std::vector<bool>(size_t(side)));
  for (int k = 0; k < 20; ++k) {
    const int width = 3 + int(random.next() * float(c.width)),
              height = 3 + int(random.next() * float(c.height));
    const Mask mask = random_mask(width, height, random);
    const ChartPosition expected = topmost_by_trying(taken, mask);
    const ChartPosition found = strip.topmost(make_shape(mask), 0, side);
    ASSERT_EQ(found.x, expected.x) << "seed " << seed << ", " << width << " x " << height;
    ASSERT_EQ(found.y, expected.y) << "seed " << seed << ", " << width << " x " << height;
    if (found.y < 0) continue;
    ++placed;
    strip.take_with_gutter(mask, found, 1);
    for (const auto& [x, y] : cells_of(mask, found))
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (std::min(x + dx, y + dy) >= 0 && std::max(x + dx, y + dy) < side)
            taken[size_t(y + dy)][size_t(x + dx)] = true;
  }
}

TEST(Pack, FindsThePlaceThatTryingEveryTexelFinds) {
  // Two words, the second one partly outside. Shapes on both sides of the height from which on
  // bands of rows are tested first.
  int placed = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) pack_both_ways({100, 30, 45}, seed, placed);
  EXPECT_GE(placed, 400);
  // Four words, and runs of more than two.
  placed = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) pack_both_ways({200, 160, 20}, seed, placed);
  EXPECT_GE(placed, 100);
}

TEST(Pack, TakesTheDirectionThatFits) {
  // A bar of 12 lies in a square of 10 in none of its turns; the same bar drawn as stairs does.
  Cells bar, stairs;
  for (int i = 0; i < 12; ++i) bar.emplace(i, 0);
  for (int i = 0; i < 9; ++i) stairs.insert({{i, i}, {i + 1, i}});
  const Directions chart{all_turns(mask_of(12, 1, bar)), all_turns(mask_of(10, 9, stairs))};
  const Progress progress;
  const Packing packing = pack_masks({chart}, 10, 0, Order::longest_side_first, progress);
  EXPECT_EQ(packing.placed, 1);
  EXPECT_EQ(packing.places[0].direction, 1);
}

TEST(Pack, AnotherOrderIsAnotherPacking) {
  // 6 x 2 before 5 x 5 by the longest side, after it by the outline.
  Cells plank, block;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 6; ++i) {
      if (j < 2) plank.emplace(i, j);
      if (i < 5) block.emplace(i, j);
    }
  const std::vector<Directions> charts{{all_turns(mask_of(6, 2, plank))},
                                       {all_turns(mask_of(5, 5, block))}};
  const Progress progress;
  for (const Order order : {Order::longest_side_first, Order::largest_outline_first}) {
    const Packing packing = pack_masks(charts, 8, 0, order, progress);
    ASSERT_EQ(packing.placed, 1);
    const size_t first = order == Order::longest_side_first ? 0 : 1;
    EXPECT_EQ(packing.places[first].x, 0);
    EXPECT_EQ(packing.places[first].y, 0);
  }
}

}  // namespace
}  // namespace luxel::atlas
