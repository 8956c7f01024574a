#include "luxel/atlas/pack.h"

#include <algorithm>
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
    if (at(width, height) >= row) return;  // larger sizes never start above smaller ones
    for (int w = std::min(width, kMost); w <= kMost; ++w)
      for (int h = std::min(height, kMost); h <= kMost; ++h) {
        int& r = rows_[index(w, h)];
        r = std::max(r, row);
      }
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

/// A mask where it would go. The lower the score the better; y = -1: no room.
struct Offer {
  ChartPosition place{-1, -1};
  double score = INFINITY;
};

/// How far down the mask hangs on average: unlike its bottom, this sees that a shape whose bulk is
/// above leaves room for others beside its tip.
double mean_row(const Mask& mask) {
  double sum = 0;
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.rows[size_t(j)]) sum += double(j) * (run.end - run.begin);
  return sum / double(std::max<uint64_t>(1, mask.texels));
}

/// What a place is judged by, less its row: the bottom, or where there is a choice of directions,
/// the bulk.
enum class Judge : uint8_t { bottom, bulk };

/// The quarter turn that comes out highest up, if it scores below the limit.
Offer best_turn(const Strip& strip, const Turns& turns, const FirstRows& first_rows, Judge judge,
                double limit) {
  Offer best{{-1, -1}, limit};
  for (size_t t = 0; t < turns.size(); ++t) {
    const Mask& mask = turns[t];
    const double hanging = judge == Judge::bulk ? mean_row(mask) : mask.height;
    const double last = std::min(double(strip.side()), std::ceil(best.score - hanging) - 1);
    ChartPosition place =
        strip.topmost(make_shape(mask), first_rows.at(mask.width, mask.height), int(last));
    if (place.y < 0) continue;
    place.turns = int(t);
    best = {place, place.y + hanging};
  }
  return best;
}

/// The best turn of all directions; the first of equals, so that threads make no difference.
Offer best_place(const Strip& strip, const Directions& chart, const FirstRows& first_rows) {
  if (chart.size() == 1)
    return best_turn(strip, chart.front(), first_rows, Judge::bottom, INFINITY);
  std::vector<Offer> offers(chart.size());
  offers[0] = best_turn(strip, chart[0], first_rows, Judge::bulk, INFINITY);
  // The others only need to look where they would beat the first.
  parallel_for(chart.size() - 1, 1, [&](size_t k, size_t) {
    offers[k + 1] = best_turn(strip, chart[k + 1], first_rows, Judge::bulk, offers[0].score);
    offers[k + 1].place.direction = int(k + 1);
  });
  return *std::min_element(offers.begin(), offers.end(), [](const Offer& a, const Offer& b) {
    return std::pair(a.place.y < 0, a.score) < std::pair(b.place.y < 0, b.score);
  });
}

/// A page while it fills.
struct Sheet {
  Strip strip;
  FirstRows first_rows;
  int height = 0;
};

/// On the wished page, else on the first after it that has room.
ChartPosition place_on_pages(const std::vector<Sheet>& sheets, const Directions& chart,
                             size_t wished) {
  for (size_t k = 0; k < sheets.size(); ++k) {
    const size_t page = (wished + k) % sheets.size();
    ChartPosition place = best_place(sheets[page].strip, chart, sheets[page].first_rows).place;
    place.page = uint32_t(page);
    if (place.y >= 0) return place;
  }
  return {-1, -1};
}

std::vector<uint32_t> large_first(const std::vector<Directions>& charts, Order by) {
  std::vector<uint32_t> order(charts.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](uint32_t m) {
    const Mask& k = charts[m].front().front();
    const int longest = std::max(k.width, k.height), shortest = std::min(k.width, k.height);
    const int first = by == Order::longest_side_first ? longest : longest + shortest;
    return std::tuple(-first, -shortest, -int64_t(k.texels), m);
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  return order;
}

}  // namespace

Turns all_turns(Mask upright) {
  // Half a turn makes no difference to a shape that nearly fills its rectangle.
  const bool full = double(upright.texels) > 0.95 * upright.width * upright.height;
  Turns turns{std::move(upright)};
  while (turns.size() < (full ? 2u : 4u)) turns.push_back(turned(turns.back()));
  return turns;
}

Packing pack_masks(const std::vector<Directions>& charts, int side, int gutter, Order order,
                   const Progress& progress, const PackPages& pages) {
  std::vector<Sheet> sheets(pages.count, Sheet{Strip(side), {}});
  Packing packing;
  packing.places.resize(charts.size());
  uint64_t total = 0, placed = 0;
  for (const Directions& d : charts) total += d.front().front().texels;
  for (const uint32_t m : large_first(charts, order)) {
    if (progress.cancelled()) return packing;
    const size_t wished = pages.wished.empty() ? 0 : pages.wished[m];
    const ChartPosition place = place_on_pages(sheets, charts[m], wished);
    if (place.y < 0) {
      packing.placed = double(placed) / double(total);
      return packing;
    }
    const Mask& mask = charts[m][size_t(place.direction)][size_t(place.turns)];
    Sheet& sheet = sheets[place.page];
    sheet.first_rows.raise(mask.width, mask.height, place.y);
    sheet.strip.take_with_gutter(mask, place, gutter);
    sheet.height = std::max(sheet.height, place.y + mask.height);
    packing.places[m] = place;
    placed += charts[m].front().front().texels;
  }
  for (const Sheet& sheet : sheets) packing.height += sheet.height;
  packing.placed = 1;
  return packing;
}

}  // namespace luxel::atlas
