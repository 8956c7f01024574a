#include "luxel/atlas/pack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "luxel/atlas/strip.h"
#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

/// Where the search for a rectangle's size begins: above, no mask of that size or smaller has found
/// room, and taken texels are never given back.
class FirstRows {
 public:
  int at(int width, int height) const { return rows_[index(width, height)]; }
  void raise(int width, int height, int row) {
    // Larger sizes never start above smaller ones.
    for (int w = std::min(width, kMost); w <= kMost && at(w, height) < row; ++w)
      for (int h = std::min(height, kMost); h <= kMost && at(w, h) < row; ++h)
        rows_[index(w, h)] = row;
  }

 private:
  /// Larger sizes count as this one, and may so start lower than they have to. Charts of that size
  /// are few, and the table stays small enough to be raised after each chart.
  static constexpr int kMost = 48;
  static size_t index(int w, int h) {
    return size_t(std::min(w, kMost)) * (kMost + 1) + size_t(std::min(h, kMost));
  }
  std::vector<int> rows_ = std::vector<int>((kMost + 1) * (kMost + 1), 0);
};

/// A page while it fills.
struct Sheet {
  Strip strip;
  FirstRows first_rows;
  /// Per mask, the row above which it is known to find no room: searches of equal masks go on where
  /// the last one ended.
  std::vector<int> no_room_above;
  int height = 0;

  /// Where the search for a mask begins.
  int first_row(uint32_t mask, const Shape& shape) const {
    return std::max(first_rows.at(shape.width, shape.height), no_room_above[mask]);
  }
};

/// A mask where it would go. The lower the score the better; y = -1: no room.
struct Offer {
  ChartPosition place{-1, -1};
  double score = INFINITY;
  std::array<int, 4> no_room_above{};  ///< per turn, as Sheet has it
};

/// Part of a shape whose row scores a place: the bottom, or where there is a choice of directions,
/// the bulk.
enum class Judge : uint8_t { bottom, bulk };

/// The quarter turn that comes out highest up, if it scores below the limit.
Offer best_turn(const Sheet& sheet, const Pieces& pieces, const Turns& turns, Judge judge,
                double limit) {
  Offer best{{-1, -1}, limit};
  for (size_t t = 0; t < turns.count; ++t) {
    const auto* first_turn = turns.mask.data();
    if (std::find(first_turn, first_turn + t, turns.mask[t]) != first_turn + t)
      continue;  // equal to one before
    const Shape& shape = pieces.shapes[turns.mask[t]];
    const double hanging = judge == Judge::bulk ? shape.mean_row : shape.height;
    const int last = int(std::min(double(sheet.strip.side()), std::ceil(best.score - hanging) - 1));
    const int first = sheet.first_row(turns.mask[t], shape);
    const Place found = sheet.strip.topmost(shape, first, last);
    best.no_room_above[t] = found.y < 0 ? std::max(first, last + 1) : found.y;
    if (found.y < 0) continue;
    best.place = {found.x, found.y, int(t)};
    best.score = found.y + hanging;
  }
  return best;
}

/// Notes the rows without room that the search of one direction has found.
void remember(const Turns& turns, const Offer& offer, Sheet& sheet) {
  for (size_t t = 0; t < turns.count; ++t) {
    int& row = sheet.no_room_above[turns.mask[t]];
    row = std::max(row, offer.no_room_above[t]);
  }
}

/// The best turn of all directions; the first of equals, so that threads make no difference.
ChartPosition best_place(const Pieces& pieces, const Directions& chart, Sheet& sheet) {
  std::vector<Offer> offers(chart.size());
  const Judge judge = chart.size() == 1 ? Judge::bottom : Judge::bulk;
  offers[0] = best_turn(sheet, pieces, chart[0], judge, INFINITY);
  // The others only need to look where they would beat the first.
  if (chart.size() > 1)
    parallel_for(chart.size() - 1, 1, [&](size_t k, size_t) {
      offers[k + 1] = best_turn(sheet, pieces, chart[k + 1], judge, offers[0].score);
      offers[k + 1].place.direction = int(k + 1);
    });
  for (size_t k = 0; k < chart.size(); ++k) remember(chart[k], offers[k], sheet);
  return std::min_element(offers.begin(), offers.end(),
                          [](const Offer& a, const Offer& b) {
                            return std::pair(a.place.y < 0, a.score) <
                                   std::pair(b.place.y < 0, b.score);
                          })
      ->place;
}

/// On the wished page, else on the first after it that has room.
ChartPosition place_on_pages(const Pieces& pieces, const Directions& chart, size_t wished,
                             std::vector<Sheet>& sheets) {
  for (size_t k = 0; k < sheets.size(); ++k) {
    const size_t page = (wished + k) % sheets.size();
    ChartPosition place = best_place(pieces, chart, sheets[page]);
    place.page = uint32_t(page);
    if (place.y >= 0) return place;
  }
  return {-1, -1};
}

std::vector<uint32_t> large_first(const Pieces& pieces, Order by) {
  std::vector<uint32_t> order(pieces.charts.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](uint32_t c) {
    const Mask& k = pieces.upright(c);
    const int longest = std::max(k.width, k.height), shortest = std::min(k.width, k.height);
    const int first = by == Order::longest_side_first ? longest : longest + shortest;
    return std::tuple(-first, -shortest, -int64_t(k.texels), c);
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  return order;
}

/// Masks with the gutter around them, made when they are first placed.
class WideMasks {
 public:
  WideMasks(const Pieces& pieces, int gutter)
      : pieces_(pieces), gutter_(gutter), masks_(pieces.masks.size()) {}
  const Mask& at(uint32_t mask) {
    Mask& wide = masks_[mask];
    if (wide.first_run.empty()) wide = widened(pieces_.masks[mask], gutter_);
    return wide;
  }

 private:
  const Pieces& pieces_;
  int gutter_;
  std::vector<Mask> masks_;
};

}  // namespace

Packing pack_pieces(const Pieces& pieces, int side, int gutter, Order order,
                    const Progress& progress, const PackPages& pages) {
  std::vector<Sheet> sheets;
  sheets.reserve(pages.count);  // a large one takes time to copy
  while (sheets.size() < pages.count)
    sheets.push_back({Strip(side), {}, std::vector<int>(pieces.masks.size(), 0)});
  WideMasks wide(pieces, gutter);
  Packing packing;
  packing.places.resize(pieces.charts.size());
  uint64_t total = 0, placed = 0;
  for (size_t c = 0; c < pieces.charts.size(); ++c) total += pieces.upright(c).texels;
  for (const uint32_t c : large_first(pieces, order)) {
    if (progress.cancelled()) return packing;
    const size_t wished = pages.wished.empty() ? 0 : pages.wished[c];
    const ChartPosition place = place_on_pages(pieces, pieces.charts[c], wished, sheets);
    if (place.y < 0) {
      packing.placed = double(placed) / double(total);
      return packing;
    }
    const uint32_t mask = pieces.charts[c][size_t(place.direction)].mask[size_t(place.turns)];
    const auto [width, height] = std::pair(pieces.masks[mask].width, pieces.masks[mask].height);
    Sheet& sheet = sheets[place.page];
    sheet.first_rows.raise(width, height, place.y);
    sheet.strip.take(wide.at(mask), {place.x - gutter, place.y - gutter});
    sheet.height = std::max(sheet.height, place.y + height);
    packing.places[c] = place;
    placed += pieces.upright(c).texels;
  }
  for (const Sheet& sheet : sheets) packing.height += sheet.height;
  packing.placed = 1;
  return packing;
}

}  // namespace luxel::atlas
