#include "luxel/viewfactor/point_visibility.h"

#include <algorithm>

#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::viewfactor {
namespace {

/// Splits a convex polygon at a plane; either part may come out empty. Both parts get the same
/// corners on the plane, so that shadows of blockers with a common edge leave no gap.
void split(PolygonView polygon, const Plane& plane, double slack, Polygon& above, Polygon& below) {
  above.clear(), below.clear();
  bool reaches_above = false, reaches_below = false;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const DVec3 &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double hp = plane.height(p), hq = plane.height(q);
    reaches_above |= hp > slack, reaches_below |= hp < -slack;
    if (hp >= -slack) above.push_back(p);
    if (hp <= slack) below.push_back(p);
    if ((hp > slack && hq < -slack) || (hp < -slack && hq > slack)) {
      const DVec3 cut = p + (q - p) * (hp / (hp - hq));
      above.push_back(cut), below.push_back(cut);
    }
  }
  if (!reaches_above || above.size() < 3) above.clear();
  if (!reaches_below || below.size() < 3) below.clear();
}

bool lies_below(PolygonView polygon, const Plane& plane, double slack) {
  return std::all_of(polygon.begin(), polygon.end(),
                     [&](const DVec3& p) { return plane.height(p) <= slack; });
}

/// The planes around the blocker's shadow, relative to the point, positive inside. Empty when the
/// point lies in the blocker's plane and sees it edge-on.
void shadow_planes(DVec3 point, const Blocker& blocker, double slack, std::vector<Plane>& planes) {
  planes.clear();
  const double height = blocker.plane.height(point);
  if (std::abs(height) <= slack) return;
  const double side = height > 0 ? -1 : 1;
  // Beyond the blocker's plane.
  planes.push_back({blocker.plane.normal * side, -height * side});
  const size_t count = blocker.corners.size();
  for (size_t i = 0; i < count; ++i) {
    const DVec3 across =
        cross(blocker.corners[i] - point, blocker.corners[(i + 1) % count] - point);
    const double size = length(across);
    if (size > 0) planes.push_back({across * (side / size), 0});
  }
}

/// True when the shadow falls on the polygon, whatever else does.
bool falls_on(PolygonView polygon, double slack, VisibilityScratch& s) {
  for (const Plane& plane : s.shadow)
    if (lies_below(polygon, plane, slack)) return false;
  s.rest.assign(polygon.begin(), polygon.end());
  for (const Plane& plane : s.shadow) {
    split(s.rest, plane, slack, s.inside, s.outside);
    std::swap(s.rest, s.inside);
    if (s.rest.empty()) return false;
  }
  return true;
}

/// Cuts the shadow out of the visible fragments.
void cut_out(double slack, VisibilityScratch& s) {
  s.next.clear();
  for (size_t i = 0; i < s.visible.size(); ++i) {
    const PolygonView fragment = s.visible[i];
    if (!falls_on(fragment, slack, s)) {
      s.next.add(fragment);
      continue;
    }
    s.rest.assign(fragment.begin(), fragment.end());
    for (const Plane& plane : s.shadow) {
      split(s.rest, plane, slack, s.inside, s.outside);
      if (!s.outside.empty()) s.next.add(s.outside);
      std::swap(s.rest, s.inside);
    }
  }
  std::swap(s.visible, s.next);
}

}  // namespace

Blocker make_blocker(PolygonView corners) {
  Blocker blocker{
      {corners.begin(), corners.end()}, plane_of(corners), viewfactor::area_m2(corners)};
  if (blocker.plane.normal == DVec3{}) blocker.area_m2 = 0;
  return blocker;
}

SeenFactor visible_point_factor(DVec3 point, DVec3 normal, PolygonView polygon,
                                const BlockerSet& set, double slack,
                                std::span<uint8_t> casts_shadow, VisibilityScratch& s) {
  s.visible.clear();
  s.polygon.clear();
  double reach = 0;
  for (const DVec3& p : polygon) {
    s.polygon.push_back(p - point);
    reach = std::max(reach, dot(s.polygon.back(), s.polygon.back()));
  }
  s.visible.add(s.polygon);
  const double whole = point_to_polygon(DVec3{}, normal, s.polygon);
  const double rounding = 1e-13 * std::sqrt(reach);
  bool shadowed = false;
  for (const uint32_t b : set.blockers) {
    shadow_planes(point, set.all[b], slack, s.shadow);
    if (s.shadow.empty() || !falls_on(s.polygon, rounding, s)) continue;
    casts_shadow[b] = 1, shadowed = true;
    cut_out(rounding, s);
    if (s.visible.size() == 0) return {0, whole};
  }
  if (!shadowed) return {whole, whole};
  double sum = 0;
  for (size_t i = 0; i < s.visible.size(); ++i)
    sum += point_to_polygon(DVec3{}, normal, s.visible[i]);
  return {sum, whole};
}

}  // namespace luxel::viewfactor
