#include "luxel/viewfactor/polygon.h"

#include <algorithm>

namespace luxel::viewfactor {

DVec3 area_vector(PolygonView polygon) {
  DVec3 twice;
  for (size_t i = 2; i < polygon.size(); ++i)
    twice += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return twice * 0.5;
}

Plane plane_of(PolygonView polygon) {
  const DVec3 normal = normalize(area_vector(polygon));
  return {normal, dot(normal, mean_corner(polygon))};
}

DVec3 mean_corner(PolygonView polygon) {
  DVec3 sum;
  for (const DVec3& p : polygon) sum += p;
  return polygon.empty() ? sum : sum * (1.0 / double(polygon.size()));
}

double radius_about(DVec3 centre, PolygonView polygon) {
  double radius = 0;
  for (const DVec3& p : polygon) radius = std::max(radius, length(p - centre));
  return radius;
}

double magnitude(PolygonView polygon) {
  double largest = 0;
  for (const DVec3& p : polygon)
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

Polygon clip_above(PolygonView polygon, const Plane& plane, double slack) {
  Polygon above;
  clip_above(polygon, plane, slack, above);
  return above;
}

void clip_above(PolygonView polygon, const Plane& plane, double slack, Polygon& above) {
  above.clear();
  bool reaches_above = false;
  double hq = polygon.empty() ? 0 : plane.height(polygon[0]);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const DVec3 &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double hp = hq;
    hq = plane.height(q);
    reaches_above |= hp > slack;
    if (hp >= -slack) above.push_back(p);
    if ((hp > slack && hq < -slack) || (hp < -slack && hq > slack))
      above.push_back(p + (q - p) * (hp / (hp - hq)));
  }
  if (!reaches_above || above.size() < 3) above.clear();
}

}  // namespace luxel::viewfactor
