#include "luxel/atlas/pack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "luxel/atlas/strip.h"
#include "luxel/base/random.h"

namespace luxel::atlas {
namespace {

using Cells = std::set<std::pair<int, int>>;  // (x, y)

Cells cells_of(const Mask& mask, ChartPosition at = {}) {
  Cells cells;
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.row(j))
      for (int i = run.begin; i < run.end; ++i) cells.emplace(at.x + i, at.y + j);
  return cells;
}

Mask mask_of(int width, int height, const Cells& cells) {
  std::vector<RowRun> runs;
  for (const auto& [i, j] : cells) runs.push_back({j, {i, i + 1}});
  return mask_of(width, height, runs);
}

/// A blob with holes that touches all four sides of its rectangle.
Mask random_mask(int width, int height, RandomStream& random) {
  Cells cells{{0, 0}, {width - 1, height - 1}};
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      if (random.next() < 0.999f) cells.emplace(i, j);
  return mask_of(width, height, cells);
}

/// A shape with one run in each row, of any length and anywhere.
Mask ragged_mask(int width, int height, RandomStream& random) {
  Cells cells{{0, 0}, {width - 1, height - 1}};
  for (int j = 0; j < height; ++j) {
    const int a = int(random.next() * float(width)), b = int(random.next() * float(width));
    for (int i = std::min(a, b); i <= std::max(a, b); ++i) cells.emplace(i, j);
  }
  return mask_of(width, height, cells);
}

TEST(Pack, AQuarterTurnMovesEveryTexelAsItSays) {
  RandomStream random{1};
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

TEST(Pack, EqualMasksAreOnePiece) {
  // A square and its turns are one mask; the bar lies in two ways, whichever of them comes first.
  Cells square, bar, upright;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) square.emplace(i, j);
    bar.emplace(i, 0), upright.emplace(0, i);
  }
  const Pieces pieces = make_pieces({{mask_of(3, 3, square)},
                                     {mask_of(3, 1, bar)},
                                     {mask_of(1, 3, upright)},
                                     {mask_of(3, 3, square)}});
  EXPECT_EQ(pieces.masks.size(), 3u);
  const auto turns = [&](size_t chart, size_t turn) {
    return cells_of(pieces.masks[pieces.charts[chart].front().mask[turn]]);
  };
  EXPECT_EQ(turns(0, 0), square);
  EXPECT_EQ(turns(1, 0), bar);
  EXPECT_EQ(turns(1, 1), upright);
  EXPECT_EQ(turns(2, 0), upright);
  EXPECT_EQ(turns(2, 1), bar);
  EXPECT_EQ(turns(3, 0), square);
}

using Grid = std::vector<std::vector<bool>>;  // [y][x], true: taken

/// The strip's search, texel by texel.
ChartPosition topmost_by_trying(const Grid& taken, const Mask& mask, int first = 0) {
  const Cells wanted = cells_of(mask);
  const int side = int(taken.size());
  for (int y = first; y + mask.height <= side; ++y)
    for (int x = 0; x + mask.width <= side; ++x)
      if (std::none_of(wanted.begin(), wanted.end(),
                       [&](auto c) { return taken[size_t(y + c.second)][size_t(x + c.first)]; }))
        return {x, y};
  return {-1, -1};
}

void take_by_hand(const Mask& mask, ChartPosition at, int gutter, Grid& taken) {
  const int side = int(taken.size());
  for (const auto& [x, y] : cells_of(mask, at))
    for (int j = std::max(0, y - gutter); j <= std::min(side - 1, y + gutter); ++j)
      for (int i = std::max(0, x - gutter); i <= std::min(side - 1, x + gutter); ++i)
        taken[size_t(j)][size_t(i)] = true;
}

/// A square, and the largest shapes to pack into it.
struct PackCase {
  int side, width, height;
  Mask (*make_mask)(int width, int height, RandomStream& random);
};

/// Packs until nothing finds room; every place must be that of the plain search.
void pack_both_ways(const PackCase& c, uint64_t seed, int& placed) {
  const int side = c.side;
  RandomStream random{seed};
  Strip strip(side);
  Grid taken;
  taken.assign(size_t(side), std::vector<bool>(size_t(side)));
  for (int k = 0; k < 20; ++k) {
    const int width = 3 + int(random.next() * float(c.width)),
              height = 3 + int(random.next() * float(c.height));
    const Mask mask = c.make_mask(width, height, random);
    const ChartPosition expected = topmost_by_trying(taken, mask);
    const Place found = strip.topmost(make_shape(mask), 0, side);
    ASSERT_EQ(found.x, expected.x) << "seed " << seed << ", " << width << " x " << height;
    ASSERT_EQ(found.y, expected.y) << "seed " << seed << ", " << width << " x " << height;
    if (found.y < 0) continue;
    ++placed;
    strip.take(widened(mask, 1), {found.x - 1, found.y - 1});
    take_by_hand(mask, {found.x, found.y}, 1, taken);
  }
}

TEST(Pack, FindsThePlaceThatTryingEveryTexelFinds) {
  // Two words, the second one partly outside.
  int placed = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed)
    pack_both_ways({100, 30, 45, random_mask}, seed, placed);
  EXPECT_GE(placed, 400);
  // Four words, and runs of more than two.
  placed = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed)
    pack_both_ways({200, 160, 20, random_mask}, seed, placed);
  EXPECT_GE(placed, 100);
  // Shapes whose rows differ, and that reach into each other.
  placed = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed)
    pack_both_ways({100, 60, 30, ragged_mask}, seed, placed);
  EXPECT_GE(placed, 400);
}

/// A page of the plain search, with what was placed on it: no larger mask is looked for above.
struct PlainPage {
  Grid taken;
  std::vector<std::pair<Mask, int>> placed;

  int first_row(const Mask& mask) const {
    int row = 0;
    for (const auto& [other, y] : placed)
      if (other.width <= mask.width && other.height <= mask.height) row = std::max(row, y);
    return row;
  }
};

/// The chart's turn that ends highest up; y = -1: none has room.
ChartPosition place_by_trying(const Pieces& pieces, const Turns& turns, int gutter,
                              PlainPage& page) {
  ChartPosition best{-1, -1};
  int best_bottom = 0;
  for (uint32_t t = 0; t < turns.count; ++t) {
    const Mask& mask = pieces.masks[turns.mask[t]];
    ChartPosition at = topmost_by_trying(page.taken, mask, page.first_row(mask));
    if (at.y < 0 || (best.y >= 0 && at.y + mask.height >= best_bottom)) continue;
    at.turns = int(t);
    best = at, best_bottom = at.y + mask.height;
  }
  if (best.y < 0) return best;
  const Mask& mask = pieces.masks[turns.mask[size_t(best.turns)]];
  take_by_hand(mask, best, gutter, page.taken);
  page.placed.emplace_back(mask, best.y);
  return best;
}

/// Many charts of few kinds, more than one page holds.
void pack_pieces_both_ways(uint64_t seed) {
  constexpr int kSide = 70, kGutter = 1;
  RandomStream random{seed};
  std::vector<Mask> kinds;
  for (const auto& [width, height] : {std::pair(14, 9), {14, 9}, {14, 3}, {6, 4}, {4, 4}, {2, 1}})
    kinds.push_back(random_mask(width, height, random));
  std::vector<std::vector<Mask>> charts;
  for (const Mask& kind : kinds)
    for (int k = 0; k < 12; ++k) charts.push_back({kind});
  const Pieces pieces = make_pieces(charts);
  const Progress progress;
  const Packing packing = pack_pieces(pieces, kSide, kGutter, Order::longest_side_first, progress,
                                      {2, std::vector<uint32_t>(charts.size(), 0)});
  ASSERT_EQ(packing.placed, 1);
  std::vector<uint32_t> order(charts.size());
  for (uint32_t c = 0; c < order.size(); ++c) order[c] = c;
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const Mask &p = charts[a].front(), &q = charts[b].front();
    return std::tuple(p.width, p.height, p.texels) > std::tuple(q.width, q.height, q.texels);
  });
  PlainPage plain;
  plain.taken.assign(kSide, std::vector<bool>(kSide));
  std::vector<PlainPage> pages(2, plain);
  for (const uint32_t c : order) {
    const Turns& turns = pieces.charts[c].front();
    uint32_t page = 0;
    ChartPosition expected = place_by_trying(pieces, turns, kGutter, pages[0]);
    if (expected.y < 0) expected = place_by_trying(pieces, turns, kGutter, pages[page = 1]);
    const ChartPosition& found = packing.places[c];
    ASSERT_EQ(std::tuple(found.page, found.x, found.y, found.turns),
              std::tuple(page, expected.x, expected.y, expected.turns))
        << "seed " << seed << ", chart " << c;
  }
  EXPECT_GT(pages[1].placed.size(), 0u);
}

TEST(Pack, PlacesEqualChartsAsThePlainSearchDoes) {
  for (uint64_t seed = 1; seed <= 10; ++seed) pack_pieces_both_ways(seed);
}

TEST(Pack, TakesTheDirectionThatFits) {
  // A bar of 12 lies in a square of 10 in none of its turns; the same bar drawn as stairs does.
  Cells bar, stairs;
  for (int i = 0; i < 12; ++i) bar.emplace(i, 0);
  for (int i = 0; i < 9; ++i) stairs.insert({{i, i}, {i + 1, i}});
  const Pieces pieces = make_pieces({{mask_of(12, 1, bar), mask_of(10, 9, stairs)}});
  const Progress progress;
  const Packing packing = pack_pieces(pieces, 10, 0, Order::longest_side_first, progress);
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
  const Pieces pieces = make_pieces({{mask_of(6, 2, plank)}, {mask_of(5, 5, block)}});
  const Progress progress;
  for (const Order order : {Order::longest_side_first, Order::largest_outline_first}) {
    const Packing packing = pack_pieces(pieces, 8, 0, order, progress);
    ASSERT_EQ(packing.placed, 1);
    const size_t first = order == Order::longest_side_first ? 0 : 1;
    EXPECT_EQ(packing.places[first].x, 0);
    EXPECT_EQ(packing.places[first].y, 0);
  }
}

}  // namespace
}  // namespace luxel::atlas
