#include "luxel/atlas/project.h"

#include <algorithm>
#include <unordered_map>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/cover.h"
#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

using Corners = std::vector<std::array<DVec2, 3>>;

/// Two directions in the plane across an axis, right-handed seen against it. Walls stand upright
/// (y is up in the world and grows downwards in a texture). The choice is far from any axis that a
/// model is likely to have, so that rounding never turns a chart.
std::pair<DVec3, DVec3> plane_directions(DVec3 axis) {
  const DVec3 up = std::abs(axis.y) < 0.93 ? DVec3{0, 1, 0} : DVec3{0, 0, -1};
  const DVec3 x = normalize(cross(up, axis));
  return {x, cross(x, axis)};
}

/// The corners of the convex hull, counter-clockwise. [Andrew79]
std::vector<DVec2> convex_hull(const Corners& corners) {
  std::vector<DVec2> points;
  for (const auto& triangle : corners)
    points.insert(points.end(), triangle.begin(), triangle.end());
  const auto before = [](DVec2 a, DVec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  std::sort(points.begin(), points.end(), before);
  std::vector<DVec2> hull(2 * points.size());
  size_t count = 0;
  const auto add = [&](DVec2 p, size_t least) {
    while (count >= least && cross(hull[count - 1] - hull[count - 2], p - hull[count - 1]) <= 0)
      --count;
    hull[count++] = p;
  };
  for (const DVec2 p : points) add(p, 2);
  const size_t lower = count + 1;
  for (size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.resize(count > 1 ? count - 1 : count);
  return hull;
}

/// The direction (at most 45 degrees off x) along which the smallest rectangle around a hull lies.
/// One of its sides lies on a hull edge. [Freeman75]
DVec2 best_direction(const std::vector<DVec2>& hull) {
  DVec2 best{1, 0};
  double best_area = INFINITY, best_turn = 0;
  for (size_t i = 0; i < hull.size(); ++i) {
    DVec2 d = hull[(i + 1) % hull.size()] - hull[i];
    const double l = length(d);
    if (!(l > 0)) continue;
    d = d * (1 / l);
    if (std::abs(d.y) > std::abs(d.x)) d = {d.y, -d.x};
    if (d.x < 0) d = {-d.x, -d.y};
    double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
    for (const DVec2 p : hull) {
      const double x = dot(d, p), y = cross(d, p);
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    const double area = (x1 - x0) * (y1 - y0), turn = std::abs(d.y);
    // Equal within rounding: the one that turns less, then the one that turns left, so that
    // symmetric charts stay upright and lie the same way whatever the unit of length.
    const bool equal = std::abs(area - best_area) <= 1e-5 * area;
    const bool nicer = std::abs(turn - best_turn) > 1e-4 ? turn < best_turn : d.y > best.y + 1e-4;
    if (equal ? nicer : area < best_area) {
      best = d, best_area = area, best_turn = turn;
    }
  }
  return best;
}

double signed_area2(const std::array<DVec2, 3>& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// Texel centres that faces of a chart already hold; a bit per texel of its rectangle, rows of
/// whole words.
struct Occupancy {
  int width, height;
  size_t words;  ///< of a row
  std::vector<uint64_t> taken;

  /// True where a face holds a centre that is taken.
  bool any_taken(const UvTriangle& t) const {
    return visit_words(t, [&](size_t at, uint64_t bits) { return (taken[at] & bits) != 0; });
  }
  void take(const UvTriangle& t) {
    visit_words(t, [&](size_t at, uint64_t bits) { return taken[at] |= bits, false; });
  }

 private:
  /// Visits the words with centres that a face holds, and the bits of these centres, until `visit`
  /// returns true. Returns true where it did.
  template <class Visit>
  bool visit_words(const UvTriangle& t, const Visit& visit) const {
    const Span rows = touched_rows(t);
    for (int j = std::max(0, rows.begin); j < std::min(height, rows.end); ++j) {
      const Span s = centre_texels(t, j, CentreRule::strictly_inside);
      const int end = std::min(width, s.end);
      for (int i = std::max(0, s.begin), next; i < end; i = next) {
        next = std::min(end, (i / 64 + 1) * 64);
        const uint64_t bits = ~uint64_t(0) >> (64 - (next - i)) << (i % 64);
        if (visit(size_t(j) * words + size_t(i) / 64, bits)) return true;
      }
    }
    return false;
  }
};

Occupancy empty_occupancy(const Corners& texels) {
  double x = 1, y = 1;
  for (const auto& t : texels)
    for (const DVec2 p : t) x = std::max(x, p.x), y = std::max(y, p.y);
  Occupancy o{int(x) + 1, int(y) + 1, size_t(x) / 64 + 1, {}};
  o.taken.resize(o.words * size_t(o.height));
  return o;
}

/// The chart's faces as positions in it, breadth-first over the surface from the first.
std::vector<uint32_t> breadth_first(const Faces& faces, const ChartFaces& chart) {
  std::unordered_map<uint32_t, uint32_t> place;
  for (uint32_t i = 0; i < chart.size(); ++i) place.emplace(chart[i], i);
  std::vector<bool> seen(chart.size());
  std::vector<uint32_t> order;
  for (uint32_t seed = 0; seed < chart.size(); ++seed) {
    if (seen[seed]) continue;
    seen[seed] = true;
    order.push_back(seed);
    for (size_t next = order.size() - 1; next < order.size(); ++next)
      for (const uint32_t g : faces.across[chart[order[next]]]) {
        const auto found = place.find(g);
        if (found == place.end() || seen[found->second]) continue;
        seen[found->second] = true;
        order.push_back(found->second);
      }
  }
  return order;
}

bool overlaps_itself(const Corners& texels) {
  Occupancy o = empty_occupancy(texels);
  for (const auto& corners : texels) {
    const UvTriangle t = uv_triangle(corners);
    if (o.any_taken(t)) return true;
    o.take(t);
  }
  return false;
}

/// Halves a chart across its long side.
std::vector<ChartFaces> cut_in_half(const Faces& faces, const FlatChart& chart) {
  const bool wide = chart.size.x >= chart.size.y;
  const double middle = 0.5 * (wide ? chart.size.x : chart.size.y);
  ChartFaces near_side, far_side;
  for (size_t i = 0; i < chart.faces.size(); ++i) {
    const DVec2 sum = chart.corners[i][0] + chart.corners[i][1] + chart.corners[i][2];
    ((wide ? sum.x : sum.y) < 3 * middle ? near_side : far_side).push_back(chart.faces[i]);
  }
  if (near_side.empty() || far_side.empty()) return {};
  std::vector<ChartFaces> parts = connected_parts(faces, near_side);
  for (ChartFaces& part : connected_parts(faces, far_side)) parts.push_back(std::move(part));
  return parts;
}

Corners scaled(const Corners& corners, double scale) {
  Corners result = corners;
  for (auto& t : result)
    for (DVec2& p : t) p = p * scale;
  return result;
}

/// One chart, or the flat charts that it had to be cut into.
std::vector<FlatChart> flatten_one(const Faces& faces, ChartFaces whole, double max_length,
                                   double texels_per_metre) {
  std::vector<FlatChart> done;
  std::vector<ChartFaces> waiting{std::move(whole)};
  while (!waiting.empty()) {
    FlatChart chart = project_chart(faces, std::move(waiting.back()));
    waiting.pop_back();
    std::vector<ChartFaces> parts;
    if (chart.faces.size() > 1 && std::max(chart.size.x, chart.size.y) > max_length)
      parts = cut_in_half(faces, chart);
    if (parts.empty() && chart.faces.size() > 1) {
      const Corners texels = scaled(chart.corners, texels_per_metre);
      if (overlaps_itself(texels))
        parts = cut_out(faces, chart.faces, overlapping_faces(faces, chart, texels));
    }
    if (parts.size() <= 1)
      done.push_back(std::move(chart));
    else
      for (size_t i = parts.size(); i-- > 0;) waiting.push_back(std::move(parts[i]));
  }
  return done;
}

}  // namespace

FlatChart project_chart(const Faces& faces, ChartFaces chart) {
  const DVec3 axis = chart_axis(faces, chart);
  const auto [right, down] = plane_directions(axis);
  const DVec3 origin = faces.corners[chart.front()][0];
  // Project along the axis, and compare the areas: slanted faces have lost some.
  FlatChart flat;
  flat.corners.resize(chart.size());
  double flat_area = 0, area = 0;
  for (size_t i = 0; i < chart.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const DVec3 p = faces.corners[chart[i]][k] - origin;
      flat.corners[i][k] = {dot(p, right), dot(p, down)};
    }
    flat_area += 0.5 * std::abs(signed_area2(flat.corners[i]));
    area += faces.area[chart[i]];
  }
  // Turn to the smallest rectangle, give the lost area back, and move to the origin.
  const DVec2 d = best_direction(convex_hull(flat.corners));
  const double scale = flat_area > 0 ? std::sqrt(area / flat_area) : 1;
  DVec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (auto& triangle : flat.corners)
    for (DVec2& p : triangle) {
      p = DVec2{dot(d, p), cross(d, p)} * scale;
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  for (auto& triangle : flat.corners)
    for (DVec2& p : triangle) p = p - low;
  flat.size = high - low;
  flat.faces = std::move(chart);
  return flat;
}

ChartFaces overlapping_faces(const Faces& faces, const FlatChart& chart, const Corners& texels) {
  Occupancy o = empty_occupancy(texels);
  ChartFaces away;
  for (const uint32_t i : breadth_first(faces, chart.faces)) {
    const UvTriangle t = uv_triangle(texels[i]);
    if (o.any_taken(t))
      away.push_back(chart.faces[i]);
    else
      o.take(t);
  }
  std::sort(away.begin(), away.end());
  return away;
}

std::vector<ChartFaces> cut_out(const Faces& faces, const ChartFaces& chart,
                                const ChartFaces& away) {
  ChartFaces rest;
  std::set_difference(chart.begin(), chart.end(), away.begin(), away.end(),
                      std::back_inserter(rest));
  std::vector<ChartFaces> parts = connected_parts(faces, rest);
  for (ChartFaces& part : connected_parts(faces, away)) parts.push_back(std::move(part));
  return parts;
}

std::vector<FlatChart> flatten_charts(const Faces& faces, std::vector<ChartFaces> charts,
                                      double max_length, double texels_per_metre,
                                      const Progress& progress) {
  std::vector<std::vector<FlatChart>> parts(charts.size());
  parallel_for(charts.size(), 16, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end && !progress.cancelled(); ++c)
      parts[c] = flatten_one(faces, std::move(charts[c]), max_length, texels_per_metre);
  });
  std::vector<FlatChart> flat;
  for (auto& some : parts)
    for (FlatChart& chart : some) flat.push_back(std::move(chart));
  return flat;
}

}  // namespace luxel::atlas
