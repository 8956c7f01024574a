#include "atlas/layout.h"

#include <algorithm>
#include <bit>

#include "atlas/directions.h"
#include "base/check.h"
#include "base/parallel.h"

namespace luxel::atlas {
namespace {

using Corners = std::vector<std::array<DVec2, 3>>;

/// All coordinates up to the resolution have this unit in a float: sums of chart corners and chart
/// places are exact, and so are the products in cover.cpp.
double grid_unit(int resolution) {
  return std::ldexp(1.0, int(std::bit_width(unsigned(resolution))) - 23);
}

/// What could be placed at one density: corners and masks per chart and direction.
struct Attempt {
  std::vector<std::vector<Corners>> corners;
  std::vector<Directions> masks;
};

Attempt make_attempt(const std::vector<TurnedChart>& charts, double density, int resolution) {
  Attempt a;
  a.corners.resize(charts.size());
  a.masks.resize(charts.size());
  parallel_for(charts.size(), 32, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      for (const FlatChart& chart : charts[c]) {
        // Only upright is a chart shortened to fit the square.
        const bool fits = std::max(chart.size.x, chart.size.y) * density < resolution - 1;
        if (!a.masks[c].empty() && !fits) continue;
        a.corners[c].push_back(texel_corners(chart, density, resolution));
        a.masks[c].push_back(all_turns(make_mask(a.corners[c].back())));
      }
  });
  return a;
}

Layout place_charts(Attempt attempt, const Packing& packing, int resolution, double density) {
  Layout layout{resolution, density, {}, {}};
  for (size_t c = 0; c < attempt.corners.size(); ++c)
    layout.local.push_back(std::move(attempt.corners[c][size_t(packing.places[c].direction)]));
  layout.texels = layout.local;
  parallel_for(layout.texels.size(), 64, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      const Place place = packing.places[c];
      const DVec2 corner{double(place.x), double(place.y)};
      const Mask& mask = attempt.masks[c][size_t(place.direction)].front();
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

uint64_t mask_texels(const std::vector<Directions>& masks) {
  uint64_t n = 0;
  for (const Directions& m : masks) n += m.front().front().texels;
  return n;
}

constexpr size_t kFewCharts = 2048;  ///< with which packing is quick, and a matter of luck

/// With few charts it is luck which order packs denser: when one nearly fits, the other may.
Packing pack_in_either_order(const std::vector<Directions>& masks, int side, int gutter,
                             const Progress& progress) {
  constexpr double kNearly = 0.85;
  Packing packing = pack_masks(masks, side, gutter, Order::longest_side_first, progress);
  if (packing.placed == 1 || packing.placed < kNearly || masks.size() > kFewCharts) return packing;
  Packing other = pack_masks(masks, side, gutter, Order::largest_outline_first, progress);
  return other.placed > packing.placed ? other : packing;
}

tl::unexpected<Error> cancelled() { return fail(ErrorCode::cancelled, "cancelled"); }

}  // namespace

Corners texel_corners(const FlatChart& chart, double density, int resolution) {
  const double unit = grid_unit(resolution);
  const double width = chart.size.x * density, height = chart.size.y * density;
  // A sliver would take far more texels than its area deserves: one texel in every row it crosses
  // and the gutter beside it. Below a quarter texel of width its length shrinks with the width.
  const auto shortened = [&](double side, double across) {
    const double fair = side * std::min(1.0, 4 * across);
    const double wanted = std::min(side, std::max(fair, 3.0));
    return std::min(wanted, resolution - 0.01) / side;
  };
  const double sx = width > 0 ? shortened(width, height) * density : density;
  const double sy = height > 0 ? shortened(height, width) * density : density;
  Corners texels = chart.corners;
  for (auto& t : texels)
    for (DVec2& p : t) p = {std::round(p.x * sx / unit) * unit, std::round(p.y * sy / unit) * unit};
  return texels;
}

bool holds_charts(int resolution, size_t charts, int gutter) {
  const size_t side = size_t(resolution + gutter) / size_t(1 + gutter);
  return side * side >= charts;
}

Result<Layout> layout_in_square(const std::vector<FlatChart>& charts, int resolution, int gutter,
                                double first_guess, Progress& progress) {
  if (!holds_charts(resolution, charts.size(), gutter))
    return fail(ErrorCode::bad_setting, "resolution {}: too small for {} charts", resolution,
                charts.size());
  const std::vector<TurnedChart> turned = directions_of(charts);
  const double side_m = std::sqrt(flat_area(charts));
  const double close_enough = charts.size() <= kFewCharts ? 1.006 : 1.012;
  double low = 0, high = INFINITY;  // densities that fit, and that do not
  double density = first_guess > 0 ? first_guess : 0.85 * resolution / side_m;
  Layout best;
  for (int round = 0; round < 60; ++round) {
    if (progress.cancelled()) return cancelled();
    Attempt attempt = make_attempt(turned, density, resolution);
    const double fill = double(mask_texels(attempt.masks)) / (double(resolution) * resolution);
    Packing packing;
    if (fill <= 1)
      packing = pack_in_either_order(attempt.masks, resolution, gutter, progress);
    else
      packing.placed = 0.9 / fill;
    double next;
    if (packing.placed == 1) {
      low = density;
      best = place_charts(std::move(attempt), packing, resolution, density);
      if (first_guess > 0 && round == 0) break;
      // Gutters do not grow with the density, but voids do: seven tenths of the way seldom fails.
      next = density * (0.3 + 0.7 * std::sqrt(double(resolution) / packing.height));
      if (next < low * 1.01) next = low * 1.02;
    } else {
      high = density;
      // Where gutters fill the square, density hardly matters until charts shrink to a texel each.
      const double most = round < 4 ? 0.985 : round < 8 ? 0.85 : 0.5;
      next = density * std::clamp(std::sqrt(packing.placed), 0.5, most);
    }
    if (low > 0 && (high < low * close_enough || round > 8)) break;
    if (next >= high || next <= low) next = std::sqrt(low * high);
    density = next;
  }
  LUXEL_CHECK(low > 0);
  return best;
}

Result<Layout> layout_at_density(const std::vector<FlatChart>& charts, double texels_per_metre,
                                 int gutter, Progress& progress) {
  const std::vector<TurnedChart> turned = directions_of(charts);
  for (int n = 1; n <= kMaxResolution; n *= 2) {
    if (progress.cancelled()) return cancelled();
    const double area = flat_area(charts) * texels_per_metre * texels_per_metre;
    double longest = 0;
    for (const FlatChart& c : charts) longest = std::max({longest, c.size.x, c.size.y});
    if (area > double(n) * n || (n < kMaxResolution && longest * texels_per_metre > n)) continue;
    Attempt attempt = make_attempt(turned, texels_per_metre, n);
    if (mask_texels(attempt.masks) > uint64_t(n) * uint64_t(n)) continue;
    const Packing packing = pack_in_either_order(attempt.masks, n, gutter, progress);
    if (packing.placed == 1) return place_charts(std::move(attempt), packing, n, texels_per_metre);
  }
  if (progress.cancelled()) return cancelled();
  return fail(
      ErrorCode::bad_setting,
      "texels per metre {}: the scene needs an atlas larger than {}; choose a lower density",
      texels_per_metre, kMaxResolution);
}

}  // namespace luxel::atlas
