#include "luxel/viewfactor/point_form_factor.h"

#include <array>

#include "luxel/base/check.h"
#include "luxel/viewfactor/both_point_form_factor.h"

namespace luxel::viewfactor {

double point_to_polygon(Vec3 point, Vec3 normal, std::span<const Vec3> polygon) {
  LUXEL_CHECK(polygon.size() >= 3 && polygon.size() <= 4);
  std::array<DVec3, 4> corners;
  for (size_t i = 0; i < polygon.size(); ++i) corners[i] = to_double(polygon[i]) - to_double(point);
  return point_to_polygon(DVec3{}, to_double(normal), {corners.data(), polygon.size()});
}

double point_to_polygon(DVec3 point, DVec3 normal, PolygonView polygon) {
  both::EdgeSum edges = both::no_edges(normal);
  DVec3 p = polygon.empty() ? DVec3{} : polygon[0] - point;
  const DVec3 first = p;
  double hp = dot(p, normal);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const DVec3 q = i + 1 < polygon.size() ? polygon[i + 1] - point : first;
    const double hq = dot(q, normal);
    both::add_side(edges, p, hp, q, hq);
    p = q, hp = hq;
  }
  return both::closed_factor(edges);
}

}  // namespace luxel::viewfactor
