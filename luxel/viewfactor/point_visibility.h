// The part of a polygon that a point sees past opaque polygons: exact shadows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// A convex opaque polygon; both sides block.
struct Blocker {
  Polygon corners;
  Plane plane;
  double area_m2 = 0;
};
/// Blockers without area block nothing: they come back with area 0.
Blocker make_blocker(PolygonView corners);

/// Convex polygons one after another.
struct Fragments {
  std::vector<DVec3> corners;
  std::vector<uint32_t> ends;  ///< one past the last corner of each

  size_t size() const { return ends.size(); }
  PolygonView operator[](size_t i) const {
    const uint32_t begin = i == 0 ? 0 : ends[i - 1];
    return {corners.data() + begin, ends[i] - begin};
  }
  void clear() { corners.clear(), ends.clear(); }
  void add(PolygonView polygon) {
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    ends.push_back(uint32_t(corners.size()));
  }
};

/// The shadows that blockers throw from one point. Planes face into the shadow, relative to the
/// point.
struct PointShadows {
  struct Range {
    uint32_t look = 0, first = 0, end = 0;  ///< of `planes`, where `look` is the present one
  };
  DVec3 point;
  double slack = 0;
  uint32_t look = 0;      ///< counts points; 0: none yet
  std::vector<Range> of;  ///< per blocker
  std::vector<Plane> planes;
};

/// Memory that one evaluation leaves to the next; one per thread.
struct VisibilityScratch {
  /// For a caller who looks from one point many times, past always the same `all`: each shadow is
  /// made once per point.
  bool keeps_shadows = false;
  Fragments visible, next;
  Polygon polygon, rest, inside;
  std::vector<double> height;
  std::vector<Plane> crossed, crossed_by_part;
  PointShadows shadows;
};

/// F from a differential element at `point` with unit `normal` to the part of the polygon that it
/// sees, and to the whole polygon. `polygon` lies above the element's horizon. Each blocker's
/// shadow, the cone from the point over the blocker, behind its plane, is cut out of the polygon;
/// what is left is a set of convex fragments, each with Lambert's exact factor.
/// casts_shadow[b] is set for each of `blockers` (indices into `all`) whose shadow falls on the
/// polygon; entries of others stay as they are. Corners closer than `slack` to a blocker's plane
/// lie on it.
struct SeenFactor {
  double visible = 0, whole = 0;
};
/// The blockers that may stand between the point and the polygon.
struct BlockerSet {
  std::span<const Blocker> all;
  std::span<const uint32_t> blockers;  ///< indices into `all`
};
SeenFactor visible_point_factor(DVec3 point, DVec3 normal, PolygonView polygon,
                                const BlockerSet& set, double slack,
                                std::span<uint8_t> casts_shadow, VisibilityScratch& scratch);

}  // namespace luxel::viewfactor
