#include "luxel/solve/hierarchical/triangulate.h"

#include <algorithm>
#include <cmath>

namespace luxel::hierarchical {
namespace {

/// The number of the point, or of one that is there already within `least_m`.
uint32_t snapped(DVec2 p, double least_m, std::vector<DVec2>& points) {
  for (size_t k = 0; k < points.size(); ++k)
    if (dot(p - points[k], p - points[k]) <= least_m * least_m) return uint32_t(k);
  points.push_back(p);
  return uint32_t(points.size() - 1);
}

/// On the outline's straight edges rounding leaves flat triangles outside of it: all three corners
/// on one edge.
bool is_flat(const Triangulation& t, const std::array<uint32_t, 3>& corners, double least_m) {
  const DVec2 a = t.points[corners[0]], b = t.points[corners[1]], c = t.points[corners[2]];
  const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  return cross(b - a, c - a) <= 1e-3 * least_m * std::sqrt(longest);
}

}  // namespace

Triangulation triangulate(std::span<const DVec2> outline, std::span<const Segment2> lines,
                          double least_m) {
  // Corners that are near each other become one.
  std::vector<DVec2> points;
  std::vector<uint32_t> border;
  for (const DVec2 p : outline) border.push_back(snapped(p, least_m, points));
  // Outline and lines are constraints.
  std::vector<std::array<uint32_t, 2>> constraints;
  for (size_t k = 0; k < border.size(); ++k)
    constraints.push_back({border[k], border[(k + 1) % border.size()]});
  for (const Segment2& s : lines) {
    const uint32_t a = snapped(s.a, least_m, points);
    constraints.push_back({a, snapped(s.b, least_m, points)});
  }
  Triangulation out = constrained_delaunay(points, constraints);
  std::erase_if(out.triangles, [&](const auto& t) { return is_flat(out, t, least_m); });
  return out;
}

}  // namespace luxel::hierarchical
