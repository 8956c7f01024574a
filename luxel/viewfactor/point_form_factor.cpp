#include "luxel/viewfactor/point_form_factor.h"

#include <array>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::viewfactor {
namespace {

/// Lambert's sum over the edges of a polygon whose corners arrive one after another.
struct EdgeSum {
  DVec3 normal;
  DVec3 first, last;
  size_t count = 0;
  double sum = 0;

  void corner(DVec3 p) {
    if (count++ == 0)
      first = p;
    else
      edge(last, p);
    last = p;
  }
  void edge(DVec3 p, DVec3 q) {
    const DVec3 across = cross(p, q);
    const double sine = length(across);
    if (sine > 0) sum += std::atan2(sine, dot(p, q)) * dot(across, normal) / sine;
  }
  double closed() {
    if (count < 3) return 0;
    edge(last, first);
    // Corners that are counter-clockwise seen from the point run clockwise about the direction to
    // it.
    return std::max(0.0, -sum / (2 * kPiDouble));
  }
};

}  // namespace

double point_to_polygon(Vec3 point, Vec3 normal, std::span<const Vec3> polygon) {
  LUXEL_CHECK(polygon.size() >= 3 && polygon.size() <= 4);
  std::array<DVec3, 4> corners;
  for (size_t i = 0; i < polygon.size(); ++i) corners[i] = to_double(polygon[i]) - to_double(point);
  return point_to_polygon(DVec3{}, to_double(normal), {corners.data(), polygon.size()});
}

double point_to_polygon(DVec3 point, DVec3 normal, PolygonView polygon) {
  // What lies below the horizon is clipped away on the fly [Sutherland74].
  EdgeSum edges{normal, {}, {}, 0, 0};
  DVec3 p = polygon.empty() ? DVec3{} : polygon[0] - point;
  const DVec3 first = p;
  double hp = dot(p, normal);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const DVec3 q = i + 1 < polygon.size() ? polygon[i + 1] - point : first;
    const double hq = dot(q, normal);
    if (hp >= 0) edges.corner(p);
    if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) edges.corner(p + (q - p) * (hp / (hp - hq)));
    p = q, hp = hq;
  }
  return edges.closed();
}

}  // namespace luxel::viewfactor
