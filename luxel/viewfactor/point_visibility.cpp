#include "luxel/viewfactor/point_visibility.h"

#include <algorithm>

#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::viewfactor {
namespace {

/// Adds the planes around the blocker's shadow, relative to the point, positive inside. None when
/// the point lies in the blocker's plane and sees it edge-on.
void add_shadow(DVec3 point, const Blocker& blocker, double slack, std::vector<Plane>& planes) {
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

/// Forgets the shadows that are kept, unless they are those from this point.
void look_from(DVec3 point, size_t blockers, double slack, PointShadows& s) {
  if (s.look > 0 && s.point == point && s.of.size() == blockers && s.slack == slack) return;
  s.point = point, s.slack = slack;
  if (s.of.size() != blockers || ++s.look == 0) s.of.assign(blockers, {}), s.look = 1;
  s.planes.clear();
}

/// A shadow that is kept.
std::span<const Plane> shadow_of(std::span<const Blocker> all, uint32_t blocker, PointShadows& s) {
  PointShadows::Range& range = s.of[blocker];
  if (range.look != s.look) {
    range = {s.look, uint32_t(s.planes.size()), 0};
    add_shadow(s.point, all[blocker], s.slack, s.planes);
    range.end = uint32_t(s.planes.size());
  }
  return {s.planes.data() + range.first, range.end - range.first};
}

/// A shadow that the next one replaces.
std::span<const Plane> new_shadow(DVec3 point, const Blocker& blocker, double slack,
                                  PointShadows& s) {
  s.planes.clear();
  add_shadow(point, blocker, slack, s.planes);
  return s.planes;
}

/// False when a polygon lies on the outer side of some plane. Else `crossed` is what of the planes
/// it lies on both sides of: none where it lies inside of all.
bool may_fall_on(PolygonView polygon, std::span<const Plane> shadow, double slack,
                 std::vector<Plane>& crossed) {
  crossed.clear();
  for (const Plane& plane : shadow) {
    double least = INFINITY, most = -INFINITY;
    for (const DVec3& p : polygon) {
      const double height = plane.height(p);
      least = std::min(least, height), most = std::max(most, height);
    }
    if (most <= slack) return false;
    if (least < -slack) crossed.push_back(plane);
  }
  return true;
}

/// Splits s.rest at a plane that it lies on both sides of: what is above stays, and what is below
/// becomes one of s.next. Both parts get the same corners on the plane, so that shadows of blockers
/// with a common edge leave no gap. A part of fewer than three corners is none; false: nothing
/// stays.
bool split(const Plane& plane, double slack, VisibilityScratch& s) {
  const size_t count = s.rest.size();
  double least = INFINITY, most = -INFINITY;
  s.height.resize(count + 1);
  for (size_t i = 0; i < count; ++i) {
    const double height = s.height[i] = plane.height(s.rest[i]);
    least = std::min(least, height), most = std::max(most, height);
  }
  if (most <= slack) return false;
  if (least >= -slack) return true;
  s.height[count] = s.height[0];
  const size_t before = s.next.corners.size();
  s.inside.resize(2 * count), s.next.corners.resize(before + 2 * count);
  DVec3 *above = s.inside.data(), *below = s.next.corners.data() + before;
  for (size_t i = 0; i < count; ++i) {
    const DVec3& p = s.rest[i];
    const double hp = s.height[i], hq = s.height[i + 1];
    if (hp >= -slack) *above++ = p;
    if (hp <= slack) *below++ = p;
    if ((hp > slack && hq < -slack) || (hp < -slack && hq > slack))
      *above++ = *below++ = p + (s.rest[i + 1 < count ? i + 1 : 0] - p) * (hp / (hp - hq));
  }
  s.inside.resize(size_t(above - s.inside.data()));
  const auto end = size_t(below - s.next.corners.data());
  if (end - before < 3) {
    s.next.corners.resize(before);
  } else {
    s.next.corners.resize(end);
    s.next.ends.push_back(uint32_t(end));
  }
  std::swap(s.rest, s.inside);
  return s.rest.size() >= 3;
}

/// Adds to s.next what of a polygon lies outside of a shadow: all of it, where the shadow does not
/// fall on it, and then the answer is false.
bool cut_out(PolygonView polygon, std::span<const Plane> shadow, double slack,
             VisibilityScratch& s) {
  const size_t corners = s.next.corners.size(), ends = s.next.size();
  bool falls = may_fall_on(polygon, shadow, slack, s.crossed_by_part);
  if (falls) s.rest.assign(polygon.begin(), polygon.end());
  for (size_t k = 0; falls && k < s.crossed_by_part.size(); ++k)
    falls = split(s.crossed_by_part[k], slack, s);
  if (falls) return true;
  s.next.corners.resize(corners), s.next.ends.resize(ends);
  s.next.add(polygon);
  return false;
}

/// Cuts a shadow out of what is visible of s.polygon. False: it does not fall on that.
bool cut_out_of_visible(double slack, VisibilityScratch& s) {
  s.next.clear();
  bool falls = false;
  for (size_t i = 0; i < s.visible.size(); ++i) falls |= cut_out(s.visible[i], s.crossed, slack, s);
  std::swap(s.visible, s.next);
  return falls;
}

/// True: the shadow falls on a part of s.polygon, seen or not.
bool falls_on_polygon(double slack, VisibilityScratch& s) {
  s.next.clear();
  return cut_out(s.polygon, s.crossed, slack, s);
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
  if (s.keeps_shadows) look_from(point, set.all.size(), slack, s.shadows);
  for (const uint32_t b : set.blockers) {
    const std::span<const Plane> shadow = s.keeps_shadows
                                              ? shadow_of(set.all, b, s.shadows)
                                              : new_shadow(point, set.all[b], slack, s.shadows);
    if (shadow.empty() || !may_fall_on(s.polygon, shadow, rounding, s.crossed)) continue;
    if (s.crossed.empty()) {
      casts_shadow[b] = 1;
      s.visible.clear();
      return {0, whole};
    }
    const bool cut = cut_out_of_visible(rounding, s);
    if (!cut && !falls_on_polygon(rounding, s)) continue;
    casts_shadow[b] = 1, shadowed = true;
    if (s.visible.size() == 0) return {0, whole};
  }
  if (!shadowed) return {whole, whole};
  double sum = 0;
  for (size_t i = 0; i < s.visible.size(); ++i)
    sum += point_to_polygon(DVec3{}, normal, s.visible[i]);
  return {sum, whole};
}

}  // namespace luxel::viewfactor
