#include "luxel/atlas/fit_charts.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "luxel/atlas/directions.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

using Corners = std::vector<std::array<DVec2, 3>>;

/// All coordinates up to the resolution have this unit in a float: sums of chart corners and chart
/// places are exact, and so are the products in cover.cpp.
double grid_unit(int resolution) {
  return std::ldexp(1.0, int(std::bit_width(unsigned(resolution))) - 23);
}

/// Charts laid at one density, to be packed.
struct Attempt {
  double density = 0;
  int page_side = 0, atlas_side = 0;
  Pieces pieces;
};

/// Only as it is laid first is a chart shortened to fit the square.
bool may_lie(const TurnedChart& chart, size_t direction, const Attempt& attempt) {
  const DVec2 size = chart[direction].size;
  return direction == 0 || std::max(size.x, size.y) * attempt.density < attempt.page_side - 1;
}

/// Corners of a chart in texels: scaled, slivers shortened to fit a page, on the fixed-point grid
/// of an atlas.
void lay_in_texels(const FlatChart& chart, const Attempt& attempt, Corners& texels) {
  const double unit = grid_unit(attempt.atlas_side), density = attempt.density;
  const double width = chart.size.x * density, height = chart.size.y * density;
  // A sliver would take far more texels than its area deserves: one texel in every row it crosses
  // and the gutter beside it. Below a quarter texel of width its length shrinks with the width.
  const auto shortened = [&](double side, double across) {
    const double fair = side * std::min(1.0, 4 * across);
    const double wanted = std::min(side, std::max(fair, 3.0));
    return std::min(wanted, attempt.page_side - 0.01) / side;
  };
  const double sx = width > 0 ? shortened(width, height) * density : density;
  const double sy = height > 0 ? shortened(height, width) * density : density;
  texels.resize(chart.corners.size());
  for (size_t t = 0; t < texels.size(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const DVec2 p = chart.corners[t][k];
      texels[t][k] = {std::round(p.x * sx / unit) * unit, std::round(p.y * sy / unit) * unit};
    }
}

Attempt make_attempt(const std::vector<TurnedChart>& charts, double density, const PageRoom& room,
                     int atlas_side) {
  Attempt attempt{density, room.side, atlas_side, {}};
  std::vector<std::vector<Mask>> masks(charts.size());
  parallel_for(charts.size(), 32, [&](size_t begin, size_t end) {
    Corners texels;
    for (size_t c = begin; c < end; ++c)
      for (size_t d = 0; d < charts[c].size(); ++d) {
        if (!may_lie(charts[c], d, attempt)) continue;
        lay_in_texels(charts[c][d], attempt, texels);
        masks[c].push_back(make_mask(texels));
      }
  });
  attempt.pieces = make_pieces(std::move(masks));
  return attempt;
}

/// The chart in the direction of that number among those in which it may lie.
const FlatChart& laid_chart(const TurnedChart& chart, int number, const Attempt& attempt) {
  size_t d = 0;  // the first may always lie
  while (number > 0)
    if (may_lie(chart, ++d, attempt)) --number;
  return chart[d];
}

Layout place_charts(const std::vector<TurnedChart>& charts, const Attempt& attempt,
                    const Packing& packing, const Arrangement& pages) {
  Layout layout{pages.side, attempt.density, {}, {}, pages.pages, {}};
  for (const ChartPosition& place : packing.places) layout.page.push_back(place.page);
  layout.local.resize(charts.size());
  layout.texels.resize(charts.size());
  parallel_for(layout.texels.size(), 64, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      const ChartPosition place = packing.places[c];
      lay_in_texels(laid_chart(charts[c], place.direction, attempt), attempt, layout.local[c]);
      layout.texels[c] = layout.local[c];
      const Page& page = layout.pages[place.page];
      const DVec2 corner{double(page.x + place.x), double(page.y + place.y)};
      const Pieces& pieces = attempt.pieces;
      const Mask& mask = pieces.masks[pieces.charts[c][size_t(place.direction)].mask.front()];
      double width = mask.width, height = mask.height;
      for (int turn = 0; turn < place.turns; ++turn) {
        for (auto& t : layout.texels[c])
          for (DVec2& p : t) p = {p.y, width - p.x};
        std::swap(width, height);
      }
      for (auto& t : layout.texels[c])
        for (DVec2& p : t) p = p + corner;
    }
  });
  return layout;
}

uint64_t mask_texels(const Pieces& pieces) {
  uint64_t n = 0;
  for (size_t c = 0; c < pieces.charts.size(); ++c) n += pieces.upright(c).texels;
  return n;
}

constexpr size_t kFewCharts = 2048;  ///< with which packing is quick, and a matter of luck

/// Shares the pages out among the instances in their order, by the texels they need: most
/// instances then lie on one page, and neighbours in the file on the same.
std::vector<uint32_t> wished_pages(const Pieces& pieces, const PageRoom& room) {
  std::vector<double> weight;
  double total = 0;
  for (size_t c = 0; c < pieces.charts.size(); ++c) {
    const Mask& m = pieces.upright(c);
    weight.push_back(double(m.texels) + room.gutter * double(m.width + m.height));
    total += weight.back();
  }
  std::vector<uint32_t> order(weight.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return room.instance[a] < room.instance[b]; });
  std::vector<uint32_t> wished(weight.size());
  double before = 0;
  for (const uint32_t c : order) {
    const double share = (before + 0.5 * weight[c]) / total;
    wished[c] = std::min(uint32_t(room.count - 1), uint32_t(room.count * share));
    before += weight[c];
  }
  return wished;
}

/// With few charts it is luck which order packs denser: when one nearly fits, the other may.
Packing pack_in_either_order(const Pieces& pieces, const PageRoom& room, const Progress& progress) {
  constexpr double kNearly = 0.85;
  PackPages pages{uint32_t(room.count), {}};
  if (room.count > 1) pages.wished = wished_pages(pieces, room);
  const auto pack = [&](Order order) {
    return pack_pieces(pieces, room.side, room.gutter, order, progress, pages);
  };
  Packing packing = pack(Order::longest_side_first);
  if (packing.placed == 1 || packing.placed < kNearly || pieces.charts.size() > kFewCharts)
    return packing;
  Packing other = pack(Order::largest_outline_first);
  return other.placed > packing.placed ? other : packing;
}

Arrangement arranged(const PageRoom& room) {
  return arrange_pages(std::vector<int>(size_t(room.count), room.side), room.gutter);
}

/// Texels of all pages.
double texels_of(const PageRoom& room) {
  return double(room.count) * (double(room.side) * room.side);
}

/// Above this a chart would need more texels than a page has.
double most_density(const std::vector<FlatChart>& charts, const PageRoom& room) {
  double area = 0;
  for (const FlatChart& chart : charts) area = std::max(area, chart.size.x * chart.size.y);
  return room.count == 1 || !(area > 0) ? INFINITY : (room.side - 1) / std::sqrt(area);
}

}  // namespace

bool holds_charts(const PageRoom& room, size_t charts) {
  const size_t side = size_t(room.side + room.gutter) / size_t(1 + room.gutter);
  return size_t(room.count) * side * side >= charts;
}

Result<Layout> layout_in_squares(const std::vector<FlatChart>& charts, const PageRoom& room,
                                 double first_guess, Progress& progress) {
  if (!holds_charts(room, charts.size()))
    return fail(ErrorCode::bad_setting, "resolution {}: too small for {} charts", room.side,
                charts.size());
  const Arrangement pages = arranged(room);
  const int atlas_side = std::max(room.atlas_side, pages.side);
  const std::vector<TurnedChart> turned = directions_of(charts);
  const double side_m = std::sqrt(flat_area(charts));
  const double close_enough = charts.size() <= kFewCharts ? 1.006 : 1.012;
  double low = 0, high = INFINITY;  // densities that fit, and that do not
  const double most = most_density(charts, room);
  const double side = room.side * std::sqrt(double(room.count));  // of a square with all texels
  double density = std::min(most, first_guess > 0 ? first_guess : 0.85 * side / side_m);
  Attempt best;
  Packing best_packing;
  for (int round = 0; round < 60; ++round) {
    LUXEL_TRY_STATUS(stopped(progress));
    Attempt attempt = make_attempt(turned, density, room, atlas_side);
    const double fill = double(mask_texels(attempt.pieces)) / texels_of(room);
    Packing packing;
    if (fill <= 1)
      packing = pack_in_either_order(attempt.pieces, room, progress);
    else
      packing.placed = 0.9 / fill;
    double next;
    if (packing.placed == 1) {
      low = density;
      best = std::move(attempt), best_packing = packing;
      if ((first_guess > 0 && round == 0) || density >= most) break;
      // Gutters do not grow with the density, but voids do: seven tenths of the way seldom fails.
      const double rows = double(room.count) * room.side;
      next = density * (0.3 + 0.7 * std::sqrt(rows / packing.height));
      if (next < low * 1.01) next = low * 1.02;
      next = std::min(next, most);
    } else {
      high = density;
      // Where gutters fill the square, density hardly matters until charts shrink to a texel each.
      const double nearly = round < 4 ? 0.985 : round < 8 ? 0.85 : 0.5;
      next = density * std::clamp(std::sqrt(packing.placed), 0.5, nearly);
    }
    if (low > 0 && (high < low * close_enough || round > 8)) break;
    if (next >= high || next <= low) next = std::sqrt(low * high);
    density = next;
  }
  LUXEL_CHECK(low > 0);
  return place_charts(turned, best, best_packing, pages);
}

Result<Layout> layout_at_density(const std::vector<FlatChart>& charts, double texels_per_metre,
                                 PageRoom room, Progress& progress) {
  room.count = 1;
  const int most = room.side > 0 ? room.side : kMaxResolution;
  const std::vector<TurnedChart> turned = directions_of(charts);
  for (int n = 1; n <= most; n = n < most ? std::min(2 * n, most) : n + 1) {
    LUXEL_TRY_STATUS(stopped(progress));
    const double area = flat_area(charts) * texels_per_metre * texels_per_metre;
    double longest = 0;
    for (const FlatChart& c : charts) longest = std::max({longest, c.size.x, c.size.y});
    if (area > double(n) * n || (n < most && longest * texels_per_metre > n)) continue;
    room.side = n;
    const Attempt attempt =
        make_attempt(turned, texels_per_metre, room, std::max(n, room.atlas_side));
    if (mask_texels(attempt.pieces) > uint64_t(n) * uint64_t(n)) continue;
    const Packing packing = pack_in_either_order(attempt.pieces, room, progress);
    if (packing.placed == 1) return place_charts(turned, attempt, packing, arranged(room));
  }
  LUXEL_TRY_STATUS(stopped(progress));
  return fail(
      ErrorCode::bad_setting,
      "texels per metre {}: the scene needs an atlas larger than {}; choose a lower density",
      texels_per_metre, most);
}

Result<Layout> layout_on_fewest_pages(const std::vector<FlatChart>& charts, double texels_per_metre,
                                      PageRoom room, Progress& progress) {
  const double page = double(room.side) * room.side;
  const int across = (kMaxMapSide + room.gutter) / (room.side + room.gutter);
  const int most = int(std::min(int64_t(kMaxPages), int64_t(across) * across));
  double fewest = std::ceil(flat_area(charts) * texels_per_metre * texels_per_metre / page);
  if (fewest <= most) {
    // As fine as the largest atlas allows: how large this one gets is not known yet.
    const std::vector<TurnedChart> turned = directions_of(charts);
    const Attempt attempt = make_attempt(turned, texels_per_metre, room, kMaxMapSide);
    fewest = std::max(1.0, std::ceil(double(mask_texels(attempt.pieces)) / page));
    for (room.count = int(std::min(fewest, most + 1.0)); room.count <= most; ++room.count) {
      LUXEL_TRY_STATUS(stopped(progress));
      const Packing packing = pack_in_either_order(attempt.pieces, room, progress);
      if (packing.placed == 1) return place_charts(turned, attempt, packing, arranged(room));
    }
  }
  LUXEL_TRY_STATUS(stopped(progress));
  return fail(ErrorCode::bad_setting,
              "texels per metre {}: the scene needs {} pages of {} x {} texels or more, and there "
              "is room for {}; choose a lower density",
              texels_per_metre, std::max(fewest, most + 1.0), room.side, room.side, most);
}

}  // namespace luxel::atlas
