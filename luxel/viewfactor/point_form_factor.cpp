#include "luxel/viewfactor/point_form_factor.h"

#include <array>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::viewfactor {
namespace {

/// atan2(sine, cosine) where the sine is above 0, off by less than 4e-16 of it: three ranges, and
/// in each a quotient of polynomials [Moshier89, atan]. Half of the time of atan2, which looks for
/// special cases and rounds the last bit.
double angle_of(double sine, double cosine) {
  constexpr double tan_quarter = 0.41421356237309505, tan_three_quarters = 2.414213562373095;
  const double across = std::abs(cosine);
  double base = 0, rise = sine, run = across;
  if (sine > tan_three_quarters * across)
    base = kPiDouble / 2, rise = -across, run = sine;
  else if (sine > tan_quarter * across)
    base = kPiDouble / 4, rise = sine - across, run = sine + across;
  const double t = rise / run, z = t * t;
  const double p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z -
                     7.500855792314704667340e1) *
                        z -
                    1.228866684490136173410e2) *
                       z -
                   6.485021904942025371773e1;
  const double q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z +
                     4.328810604912902668951e2) *
                        z +
                    4.853903996359136964868e2) *
                       z +
                   1.945506571482613964425e2;
  const double angle = base + (t + t * z * p / q);
  return cosine < 0 ? kPiDouble - angle : angle;
}

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
    if (sine > 0) sum += angle_of(sine, dot(p, q)) * dot(across, normal) / sine;
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
