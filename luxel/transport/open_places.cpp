#include "luxel/transport/open_places.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "luxel/atlas/cover.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/transport/back_faces.h"

namespace luxel::transport {
namespace {

constexpr int kGrid = 4;  ///< places looked at along a texel's side
/// Places looked at in the part of a texel that a chart covers, at most.
constexpr size_t kMostPlaces = 48;

/// The middles of the four quarters of a triangle, as weights of its corners.
constexpr std::array<std::array<double, 3>, 4> kQuarters{{{1 / 3.0, 1 / 3.0, 1 / 3.0},
                                                          {2 / 3.0, 1 / 6.0, 1 / 6.0},
                                                          {1 / 6.0, 2 / 3.0, 1 / 6.0},
                                                          {1 / 6.0, 1 / 6.0, 2 / 3.0}}};

/// Places all over the part of a triangle that lies in a texel.
void add_places(const atlas::Atlas& atlas, uint32_t triangle, const atlas::Texel& texel,
                std::vector<ChartPlace>& places) {
  const auto& c = atlas.corners[triangle];
  const DVec2 a = to_double(c[0]), b = to_double(c[1]), d = to_double(c[2]);
  const int x = int(texel.x), y = int(texel.y);
  if (std::max({a.x, b.x, d.x}) < x || std::min({a.x, b.x, d.x}) > x + 1 ||
      std::max({a.y, b.y, d.y}) < y || std::min({a.y, b.y, d.y}) > y + 1)
    return;
  const double area2 = cross(b - a, d - a);
  const auto add = [&](double u, double v) {
    const Barycentric at{float(u), float(v)};
    if (at.u > 0 && at.v > 0 && at.u + at.v < 1)
      places.push_back({interpolate(c[0], c[1], c[2], at), triangle, at});
  };
  if (area2 == 0) {  // squeezed to a line: its texels belong to all of it
    for (const auto& q : kQuarters)
      for (const auto& r : kQuarters) add((q[1] + r[1]) / 2, (q[2] + r[2]) / 2);
    return;
  }
  const auto [corner, count] = atlas::clipped_corners(atlas::uv_triangle({a, b, d}), x, y);
  for (size_t k = 2; k < count; ++k)
    for (const auto& q : kQuarters) {
      const DVec2 p = corner[0] * q[0] + corner[k - 1] * q[1] + corner[k] * q[2] +
                      DVec2{double(x), double(y)} - a;
      add(cross(p, d - a) / area2, cross(b - a, p) / area2);
    }
}

/// The places of the grid, its corners first.
constexpr auto kPlaces = [] {
  std::array<Vec2, kGrid * kGrid> out{};
  size_t corners = 0, others = 4;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      const bool is_corner = i % (kGrid - 1) == 0 && j % (kGrid - 1) == 0;
      out[is_corner ? corners++ : others++] = {(float(i) + 0.5f) / kGrid,
                                               (float(j) + 0.5f) / kGrid};
    }
  return out;
}();

}  // namespace

bool PlaceSearch::in_the_open(const scene::SurfacePoint& p) const {
  const FlatPoint at = flat_point(scene, p);
  return is_in_the_open(scene, tracer, just_above(at), at.normal);
}

ChartTriangles triangles_of_charts(const atlas::Atlas& atlas) {
  ChartTriangles out{std::vector<uint32_t>(atlas.chart_count + 1), {}};
  for (const uint32_t chart : atlas.chart) ++out.first[chart + 1];
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.all.resize(atlas.chart.size());
  std::vector<uint32_t> next = out.first;
  for (uint32_t t = 0; t < atlas.chart.size(); ++t) out.all[next[atlas.chart[t]]++] = t;
  return out;
}

std::optional<scene::SurfacePoint> open_place_of_grid(const PlaceSearch& in,
                                                      const atlas::Texel& texel, bool is_open) {
  const auto& corners = in.atlas.corners[texel.triangle_number];
  struct Candidate {
    Vec2 place;
    Barycentric at;
  };
  std::vector<Candidate> open;
  Vec2 middle{0, 0};
  size_t in_triangle = 0;
  for (size_t k = 0; k < kPlaces.size(); ++k) {
    // Four corners like the sample between them: so are most texels all over, and one across a
    // straight edge never is.
    if (k == 4 && in_triangle == 4 && open.size() == (is_open ? 4u : 0u)) return {};
    const Vec2 p = Vec2{float(texel.x), float(texel.y)} + kPlaces[k];
    const Barycentric at = atlas::barycentric_in(corners, p);
    if (at.u <= 0 || at.v <= 0 || at.u + at.v >= 1) continue;
    ++in_triangle;
    if (!in.in_the_open({texel.sample.instance, texel.sample.triangle, at})) continue;
    open.push_back({p, at}), middle = middle + p;
  }
  if (open.empty() || (is_open && open.size() == in_triangle)) return {};
  middle = middle * (1 / float(open.size()));
  const auto nearest = std::ranges::min_element(
      open, {}, [&](const Candidate& c) { return length(c.place - middle); });
  return scene::SurfacePoint{texel.sample.instance, texel.sample.triangle, nearest->at};
}

std::optional<ChartPlace> open_place_of_chart(const PlaceSearch& in, const atlas::Texel& texel,
                                              const ChartTriangles& charts) {
  const uint32_t chart = in.atlas.chart[texel.triangle_number];
  std::vector<ChartPlace> places, open;
  for (uint32_t k = charts.first[chart]; k < charts.first[chart + 1]; ++k)
    add_places(in.atlas, charts.all[k], texel, places);
  const size_t step = (places.size() + kMostPlaces - 1) / kMostPlaces;
  Vec2 middle{0, 0};
  for (size_t k = 0; k < places.size(); k += step) {
    const auto [instance, triangle] =
        scene::drawn_triangle(in.atlas.first_triangle, places[k].triangle);
    if (!in.in_the_open({instance, triangle, places[k].at})) continue;
    open.push_back(places[k]), middle = middle + places[k].texels;
  }
  if (open.empty()) return {};
  middle = middle * (1 / float(open.size()));
  return *std::ranges::min_element(open, {},
                                   [&](const ChartPlace& p) { return length(p.texels - middle); });
}

}  // namespace luxel::transport
