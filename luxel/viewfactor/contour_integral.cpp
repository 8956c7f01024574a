#include "luxel/viewfactor/contour_integral.h"

#include <algorithm>
#include <array>
#include <complex>

#include "luxel/viewfactor/quadrature.h"

namespace luxel::viewfactor {
namespace {

/// A piece of an outline in units in which both polygons have about unit size.
struct Edge {
  DVec3 from, to, direction;
  double length = 0;
};

std::vector<Edge> edges_of(PolygonView polygon, DVec3 origin, double scale) {
  std::vector<Edge> edges;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const DVec3 from = (polygon[i] - origin) * scale;
    const DVec3 to = (polygon[(i + 1) % polygon.size()] - origin) * scale;
    const double l = length(to - from);
    if (l > 0) edges.push_back({from, to, (to - from) * (1 / l), l});
  }
  return edges;
}

/// int ln |x - y| dy along the edge, less the edge's length (a constant, which drops out of the
/// sum over a closed outline). With t the coordinate of the edge's points about the foot of the
/// perpendicular from x, and d its length:
///   => [ t ln(t^2 + d^2) / 2 ] from t0 to t1  +  d * (the angle under which x sees the edge)
double inner_integral(DVec3 x, const Edge& edge) {
  const DVec3 r = x - edge.from;
  const double t0 = -dot(r, edge.direction), t1 = t0 + edge.length;
  const DVec3 away = r + edge.direction * t0;
  const double d2 = dot(away, away), d = std::sqrt(d2);
  const double q0 = t0 * t0 + d2, q1 = t1 * t1 + d2;
  double sum = d > 0 ? d * std::atan2(d * edge.length, d2 + t0 * t1) : 0;
  if (q1 > 0) sum += 0.5 * t1 * std::log(q1);
  if (q0 > 0) sum -= 0.5 * t0 * std::log(q0);
  return sum;
}

/// Where the inner integral, as a function of the coordinate s along an edge, is singular in the
/// complex plane: s +- i h. It is so where x meets an end of the other edge or its line.
struct Singularity {
  double s = 0, h = 0;
};

std::array<Singularity, 3> singularities(const Edge& edge, const Edge& other) {
  const auto of_point = [&](DVec3 p) {
    const DVec3 r = p - edge.from;
    const double s = dot(r, edge.direction);
    return Singularity{s, length(r - edge.direction * s)};
  };
  const double c = dot(edge.direction, other.direction);
  const DVec3 across = cross(edge.direction, other.direction);
  const double sine2 = dot(across, across);
  std::array<Singularity, 3> found{of_point(other.from), of_point(other.to), {0, 1e30}};
  if (sine2 < 1e-24) return found;  // parallel lines stay apart
  const DVec3 r = other.from - edge.from;
  const double s = (dot(r, edge.direction) - c * dot(r, other.direction)) / sine2;
  // |x(s) - line|^2 = gap^2 + sine^2 (s - s0)^2
  found[2] = {s, std::abs(dot(r, across)) / sine2};
  return found;
}

/// The Bernstein ellipse through a singularity, about the piece [begin, end].
double ellipse(const Singularity& at, double begin, double end) {
  const double half = 0.5 * (end - begin);
  const std::complex<double> z((at.s - 0.5 * (begin + end)) / half, at.h / half);
  const std::complex<double> root = std::sqrt(z * z - 1.0);
  return std::max(std::abs(z + root), std::abs(z - root));
}

double piece_integral(const Edge& edge, const Edge& other, double begin, double end,
                      std::span<const Node> rule) {
  double sum = 0;
  for (const Node& node : rule) {
    // From the nearer end, so that the distance to a corner that both edges share stays exact.
    const bool near_end = end == edge.length && node.to_end < node.at;
    const DVec3 x = near_end ? edge.to - edge.direction * (node.to_end * (end - begin))
                             : edge.from + edge.direction * (begin + node.at * (end - begin));
    sum += node.weight * inner_integral(x, other);
  }
  return sum * (end - begin);
}

/// Gauss where the singularities are far enough; else the edge is cut at their feet, and pieces
/// that are still too close to one get the rule for singular ends.
double double_integral(const Edge& edge, const Edge& other, double tolerance) {
  const std::array<Singularity, 3> singular = singularities(edge, other);
  const auto nodes_for = [&](double begin, double end) {
    double rho = 1e30;
    for (const Singularity& at : singular) rho = std::min(rho, ellipse(at, begin, end));
    return gauss_nodes_for(rho, tolerance);
  };
  const int whole = nodes_for(0, edge.length);
  if (whole <= kMaxGaussNodes)
    return piece_integral(edge, other, 0, edge.length, gauss_rule(whole));
  std::array<double, 5> cut{0, edge.length, edge.length, edge.length, edge.length};
  size_t cuts = 1;
  const double margin = 1e-12 * edge.length;
  bool at_the_ends = true;  // no singularity is only close to the edge
  for (const Singularity& at : singular) {
    if (at.s > margin && at.s < edge.length - margin) cut[cuts++] = at.s;
    const double beside = std::max({0.0, -at.s, at.s - edge.length});
    const double distance = std::hypot(beside, at.h);
    if (distance > 1e-14 && distance < 0.3 * edge.length) at_the_ends = false;
  }
  std::sort(cut.begin(), cut.end());
  double sum = 0;
  for (size_t i = 0; i < cuts; ++i) {
    if (cut[i + 1] - cut[i] <= margin) continue;
    const int nodes = nodes_for(cut[i], cut[i + 1]);
    const TanhSinh singular_rule = at_the_ends ? TanhSinh::coarse : TanhSinh::fine;
    sum +=
        piece_integral(edge, other, cut[i], cut[i + 1],
                       nodes <= kMaxGaussNodes ? gauss_rule(nodes) : tanh_sinh_rule(singular_rule));
  }
  return sum;
}

}  // namespace

ExchangeArea contour_exchange_area(PolygonView a, PolygonView b, double tolerance) {
  // Units of the distance between far corners: ln r is then of the order of one.
  const DVec3 origin = a[0];
  const double reach = std::max(radius_about(origin, a), radius_about(origin, b));
  const std::vector<Edge> edges_a = edges_of(a, origin, 1 / reach);
  const std::vector<Edge> edges_b = edges_of(b, origin, 1 / reach);
  double sum = 0, size = 0;
  for (const Edge& i : edges_a)
    for (const Edge& j : edges_b) {
      const double cosine = dot(i.direction, j.direction);
      if (std::abs(cosine) < 1e-15) continue;
      const double part = cosine * double_integral(i, j, tolerance);
      sum += part;
      size += std::abs(part) + std::abs(cosine) * i.length * j.length;
    }
  const double unit = reach * reach / (2 * kPiDouble);
  return {sum * unit, 1e-16 * size * unit};
}

}  // namespace luxel::viewfactor
