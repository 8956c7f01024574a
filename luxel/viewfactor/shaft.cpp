#include "luxel/viewfactor/shaft.h"

#include <algorithm>

namespace luxel::viewfactor {
namespace {

/// Adds the plane through an edge and a corner if both polygons lie on one side of it.
void add_support(DVec3 from, DVec3 to, DVec3 corner, PolygonView a, PolygonView b, Shaft& shaft) {
  const DVec3 across = cross(to - from, corner - from);
  const double size = length(across);
  if (!(size > 1e-12 * dot(to - from, to - from))) return;
  Plane plane{across * (1 / size), 0};
  plane.offset = dot(plane.normal, from);
  bool above = false, below = false;
  for (const PolygonView polygon : {a, b})
    for (const DVec3& p : polygon) {
      const double height = plane.height(p);
      above |= height > shaft.slack;
      below |= height < -shaft.slack;
      if (above && below) return;
    }
  if (above) plane = {-plane.normal, -plane.offset};
  if (above != below) shaft.planes.push_back(plane);
}

void add_supports(PolygonView edges_of, PolygonView corners_of, Shaft& shaft) {
  for (size_t i = 0; i < edges_of.size(); ++i)
    for (const DVec3& corner : corners_of)
      add_support(edges_of[i], edges_of[(i + 1) % edges_of.size()], corner, edges_of, corners_of,
                  shaft);
}

double depth_below(const Plane& plane, PolygonView polygon) {
  double depth = 0;
  for (const DVec3& p : polygon) depth = std::max(depth, -plane.height(p));
  return depth;
}

/// The share of the lines with depths below a facet of up to w_a and w_b that run no deeper than d
/// where they are the share t of their way from a to b.
double share_of_lines(double d, double t, double w_a, double w_b) {
  const double at_a = (1 - t) * w_a, at_b = t * w_b;  // the depth there is the sum of two parts
  if (d >= at_a + at_b) return 1;
  const double large = std::max(at_a, at_b), small = std::min(at_a, at_b);
  if (small <= 1e-12 * large) return std::min(1.0, d / large);
  return std::min({1.0, d / large, d * d / (2 * small * large)});
}

}  // namespace

Shaft shaft_between(PolygonView a, PolygonView b, double slack) {
  Shaft shaft{{}, slack};
  for (const PolygonView polygon : {a, b}) {
    const Plane front = plane_of(polygon);
    shaft.planes.push_back({-front.normal, -front.offset});
  }
  add_supports(a, b, shaft);
  add_supports(b, a, shaft);
  return shaft;
}

bool is_outside(const Shaft& shaft, PolygonView polygon) {
  for (const Plane& plane : shaft.planes) {
    bool reaches_in = false;
    for (const DVec3& p : polygon) reaches_in |= plane.height(p) < -shaft.slack;
    if (!reaches_in) return true;
  }
  return false;
}

bool is_outside(const Shaft& shaft, DVec3 lower, DVec3 upper) {
  for (const Plane& plane : shaft.planes) {
    const DVec3 deepest{plane.normal.x > 0 ? lower.x : upper.x,
                        plane.normal.y > 0 ? lower.y : upper.y,
                        plane.normal.z > 0 ? lower.z : upper.z};
    if (plane.height(deepest) >= -shaft.slack) return true;
  }
  return false;
}

Intrusion intrusion(const Shaft& shaft, PolygonView a, PolygonView b, PolygonView polygon) {
  Polygon inside(polygon.begin(), polygon.end());
  for (const Plane& plane : shaft.planes) {
    inside = clip_above(inside, {-plane.normal, -plane.offset}, shaft.slack);
    if (inside.empty()) return {};
  }
  const Plane plane_a = plane_of(a), plane_b = plane_of(b);
  double first = 1, last = 0;  // of the way from a to b
  for (const DVec3& p : inside) {
    const double from_a = std::max(0.0, plane_a.height(p)),
                 from_b = std::max(0.0, plane_b.height(p));
    const double t = from_a + from_b > 0 ? from_a / (from_a + from_b) : 0.5;
    first = std::min(first, t), last = std::max(last, t);
  }
  Intrusion found{area_m2(inside), 1};
  for (const Plane& plane : shaft.planes) {
    const double d = depth_below(plane, inside);
    const double w_a = depth_below(plane, a), w_b = depth_below(plane, b);
    const double share =
        std::max(share_of_lines(d, first, w_a, w_b), share_of_lines(d, last, w_a, w_b));
    if (w_a > 0 && w_b > 0) found.share = std::min(found.share, 4 * share);
  }
  return found;
}

}  // namespace luxel::viewfactor
