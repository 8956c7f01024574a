#include "luxel/solve/hierarchical/segments.h"

#include <algorithm>
#include <cmath>

namespace luxel::hierarchical {

bool clip_linear(Segment& segment, double at_a, double at_b, double low, double high) {
  double t0 = 0, t1 = 1;
  const double slope = at_b - at_a;
  for (const auto& [limit, sign] : {std::pair{low, 1.0}, std::pair{high, -1.0}}) {
    const double inside = sign * (at_a - limit), change = sign * slope;
    if (change == 0 && inside < 0) return false;
    if (change > 0) t0 = std::max(t0, -inside / change);
    if (change < 0) t1 = std::min(t1, -inside / change);
  }
  if (!(t0 < t1)) return false;
  const Segment all = segment;
  segment = {all.a + (all.b - all.a) * t0, all.a + (all.b - all.a) * t1};
  return true;
}

bool clip_to(PolygonView polygon, DVec3 normal, Segment& segment) {
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec3 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
    const DVec3 inwards = normalize(cross(normal, edge));
    if (!clip_linear(segment, dot(inwards, segment.a - polygon[k]),
                     dot(inwards, segment.b - polygon[k]), 0, INFINITY))
      return false;
  }
  return true;
}

bool meet(const Plane& p, const Plane& q, DVec3 about, double reach, Segment& out) {
  const DVec3 d = cross(p.normal, q.normal);
  const double size2 = dot(d, d);
  if (size2 < 1e-16) return false;
  const DVec3 on = (cross(q.normal, d) * p.offset + cross(d, p.normal) * q.offset) * (1 / size2);
  const DVec3 unit = normalize(d);
  const DVec3 middle = on + unit * dot(about - on, unit);
  out = {middle - unit * reach, middle + unit * reach};
  return true;
}

}  // namespace luxel::hierarchical
