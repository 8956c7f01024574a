#include "luxel/viewfactor/polygon_form_factor.h"

#include <algorithm>

#include "luxel/viewfactor/contour_integral.h"
#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/quadrature.h"

namespace luxel::viewfactor {
namespace {

/// Calls visit(point, area weight) at the nodes of a rule on every triangle of the polygon's fan,
/// each the image of the unit square: (s, t) -> p0 + s (p1 - p0) + s t (p2 - p1), Jacobian 2 A s.
template <class Visit>
void for_each_node(PolygonView polygon, std::span<const Node> rule, const Visit& visit) {
  for (size_t i = 2; i < polygon.size(); ++i) {
    const DVec3 u = polygon[i - 1] - polygon[0], v = polygon[i] - polygon[i - 1];
    const double twice_area = length(cross(u, v));
    for (const Node& s : rule)
      for (const Node& t : rule)
        visit(polygon[0] + u * s.at + v * (s.at * t.at), twice_area * s.at * s.weight * t.weight);
  }
}

/// int_a F(dA -> b) dA by Lambert's formula.
double integral_of_point_factors(PolygonView a, PolygonView b, std::span<const Node> rule) {
  const DVec3 normal = plane_of(a).normal;
  double sum = 0;
  for_each_node(a, rule,
                [&](DVec3 x, double weight) { sum += weight * point_to_polygon(x, normal, b); });
  return sum;
}

/// int_a int_b cos cos / (pi r^2): the definition, for polygons so far apart that every other way
/// is the difference of large numbers.
double double_area_integral(PolygonView a, PolygonView b, std::span<const Node> rule) {
  const DVec3 normal_a = plane_of(a).normal, normal_b = plane_of(b).normal;
  double sum = 0;
  for_each_node(a, rule, [&](DVec3 x, double weight_x) {
    for_each_node(b, rule, [&](DVec3 y, double weight_y) {
      const DVec3 r = y - x;
      const double r2 = dot(r, r);
      sum += weight_x * weight_y * dot(normal_a, r) * -dot(normal_b, r) / (kPiDouble * r2 * r2);
    });
  });
  return sum;
}

/// A lower bound on the distance of the polygons, and the radii of balls around them.
struct Separation {
  double distance = 0, radius_a = 0, radius_b = 0;
};
Separation separation(PolygonView a, PolygonView b, const Plane& plane_a, const Plane& plane_b) {
  const DVec3 centre_a = mean_corner(a), centre_b = mean_corner(b);
  Separation s;
  s.radius_a = radius_about(centre_a, a), s.radius_b = radius_about(centre_b, b);
  s.distance = length(centre_a - centre_b) - s.radius_a - s.radius_b;
  double above_a = INFINITY, above_b = INFINITY;  // each lies in front of the other
  for (const DVec3& p : b) above_a = std::min(above_a, plane_a.height(p));
  for (const DVec3& p : a) above_b = std::min(above_b, plane_b.height(p));
  s.distance = std::max({0.0, s.distance, above_a, above_b});
  return s;
}

/// From half a ball's size z = distance / radius away, the nearest singularity lies on the
/// Bernstein ellipse with rho = z + sqrt(z^2 + 1).
std::span<const Node> rule_at(double distance, double radius, double tolerance) {
  const double z = distance / radius;
  // Two more, because grazing light is less than the terms it is the sum of.
  const int nodes = gauss_nodes_for(z + std::sqrt(z * z + 1), tolerance) + 2;
  return gauss_rule(std::min(kMaxGaussNodes, nodes));
}

/// Polygons that lie wholly in front of each other.
ExchangeArea facing_exchange_area(PolygonView a, PolygonView b, double tolerance) {
  const Plane plane_a = plane_of(a), plane_b = plane_of(b);
  const Separation s = separation(a, b, plane_a, plane_b);
  const double small = std::min(s.radius_a, s.radius_b), large = std::max(s.radius_a, s.radius_b);
  if (s.distance > 300 * large)
    return {double_area_integral(a, b, rule_at(s.distance, large, tolerance)), 0};
  const bool a_is_smaller = s.radius_a <= s.radius_b;
  const PolygonView smaller = a_is_smaller ? a : b, larger = a_is_smaller ? b : a;
  if (s.distance > 3 * small)
    return {integral_of_point_factors(smaller, larger, rule_at(s.distance, small, tolerance)), 0};
  const ExchangeArea contour = contour_exchange_area(smaller, larger, tolerance);
  if (contour.rounding <= 1e-9 * contour.value) return contour;
  // Slivers, and small polygons that touch large ones: no cancellation over the smaller area.
  const double value = integral_of_point_factors(smaller, larger, tanh_sinh_rule(TanhSinh::coarse));
  return {value, std::min(contour.rounding, 1e-7 * value)};
}

}  // namespace

ExchangeArea polygon_exchange_area(PolygonView a, PolygonView b, double tolerance, double slack) {
  const Plane plane_a = plane_of(a), plane_b = plane_of(b);
  if (plane_a.normal == DVec3{} || plane_b.normal == DVec3{}) return {};
  const double rounding = std::max(slack, 1e-14 * std::max(magnitude(a), magnitude(b)));
  const Polygon front_b = clip_above(b, plane_a, rounding);
  const Polygon front_a = clip_above(a, plane_b, rounding);
  if (front_a.empty() || front_b.empty()) return {};
  ExchangeArea exchange = facing_exchange_area(front_a, front_b, tolerance);
  exchange.value = std::max(0.0, exchange.value);
  return exchange;
}

double polygon_form_factor(PolygonView a, PolygonView b) {
  const double area = area_m2(a);
  return area > 0 ? polygon_exchange_area(a, b).value / area : 0;
}

}  // namespace luxel::viewfactor
