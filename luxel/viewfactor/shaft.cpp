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
  Intrusion found{area_m2(inside), 1};
  for (const Plane& plane : shaft.planes) {
    const double d = depth_below(plane, inside);
    const double widths = depth_below(plane, a) * depth_below(plane, b);
    if (widths > 0) found.share = std::min(found.share, 8 * d * d / widths);
  }
  return found;
}

}  // namespace luxel::viewfactor
