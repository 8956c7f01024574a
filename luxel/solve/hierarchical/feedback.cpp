#include "luxel/solve/hierarchical/feedback.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "luxel/base/parallel.h"

namespace luxel::hierarchical {
namespace {

/// The iteration ends when a sweep changes light by less than this part of its mean. It is the
/// default of SolveParams::tolerance, so that what is fed back is known as well as what was solved.
constexpr double kTolerance = 1e-4;

/// Sums of weighted squares: the linear function over an element nearest to what is added.
struct Fit {
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> moments = Eigen::Matrix<double, 4, 3>::Zero();

  void add(const Element& e, DVec3 place, Rgb value, double weight) {
    const auto [s, t] = place_in(e, place);
    Eigen::Vector4d at = Eigen::Vector4d::Zero();  // of the functions that are 1 at one corner
    for (uint32_t k = 0; k < e.corners; ++k) {
      std::array<double, 4> unit{};
      unit[k] = 1;
      at[k] = linear_at(unit, e.corners, s, t);
    }
    squares += weight * at * at.transpose();
    moments += weight * at * Eigen::RowVector3d{double(value.x), double(value.y), double(value.z)};
  }

  /// Bent as far towards the mean as it would be negative.
  std::array<Rgb, 4> corners(uint32_t n) const {
    Eigen::Matrix4d all = squares;
    if (n == 3) all(3, 3) = 1;  // a corner that is not there
    const Eigen::Matrix<double, 4, 3> at = all.ldlt().solve(moments);
    std::array<Rgb, 4> out{};
    if (!at.allFinite()) return out;
    for (const auto& [c, channel] :
         {std::pair{0, &Rgb::x}, std::pair{1, &Rgb::y}, std::pair{2, &Rgb::z}}) {
      double mean = 0, shrink = 1;
      for (uint32_t k = 0; k < n; ++k) mean += at(k, c) / n;
      mean = std::max(mean, 0.0);
      for (uint32_t k = 0; k < n; ++k)
        if (at(k, c) < 0) shrink = std::min(shrink, mean / (mean - at(k, c)));
      for (uint32_t k = 0; k < n; ++k) out[k].*channel = float(mean + (at(k, c) - mean) * shrink);
    }
    return out;
  }
};

/// A leaf's exact light as the linear function nearest to it.
std::array<Rgb, 4> fit_of(const Element& e, const LightMesh& mesh, uint32_t first, uint32_t end) {
  Fit fit;
  // Middles of the edges of each triangle's quarters: exact for quadratic functions, and nearly for
  // what a leaf's are times a quadratic one.
  constexpr std::array<std::array<float, 2>, 12> kAt{{{0.25f, 0},
                                                      {0.25f, 0.25f},
                                                      {0, 0.25f},
                                                      {0.75f, 0},
                                                      {0.75f, 0.25f},
                                                      {0.5f, 0.25f},
                                                      {0.25f, 0.5f},
                                                      {0.25f, 0.75f},
                                                      {0, 0.75f},
                                                      {0.25f, 0.25f},
                                                      {0.5f, 0.25f},
                                                      {0.25f, 0.5f}}};
  for (uint32_t k = first; k < end; ++k) {
    const auto& v = mesh.triangles[k].vertex;
    const DVec3 a = mesh.vertices[v[0]], u = mesh.vertices[v[1]] - a, w = mesh.vertices[v[2]] - a;
    const double area = 0.5 * length(cross(u, w));
    for (const auto& [s, t] : kAt)
      fit.add(e, a + u * double(s) + w * double(t), value_of(mesh.interpolant[k], s, t),
              area / kAt.size());
  }
  return fit.corners(e.corners);
}

/// Sets what no link brings, so that leaves have the light that their triangles show; returns that,
/// per element.
std::vector<std::array<Rgb, 4>> correct(Solution& s, const LightMesh& mesh) {
  std::vector<std::array<Rgb, 4>> exact(s.tree.elements.size());
  parallel_for(s.tree.elements.size(), 64, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e) {
      const uint32_t first = mesh.first_of_element[e], last = mesh.first_of_element[e + 1];
      if (first == last) continue;
      ElementLight& l = s.light.elements[e];
      exact[e] = fit_of(s.tree.elements[e], mesh, first, last);
      for (uint32_t k = 0; k < s.tree.elements[e].corners; ++k)
        l.unlinked[k] = exact[e][k] - l.arriving[k];
    }
  });
  return exact;
}

/// The pieces of all leaves: what they have by now, and by how much the triangles differed from
/// linear.
void add_pieces(Solution& s, const LightMesh& mesh, std::span<const std::array<Rgb, 4>> exact) {
  s.light.first_piece = mesh.first_of_element;
  s.light.pieces.clear();
  for (size_t k = 0; k < mesh.triangles.size(); ++k) {
    const LightTriangle& t = mesh.triangles[k];
    const Element& e = s.tree.elements[t.leaf];
    ElementLight& l = s.light.elements[t.leaf];
    const std::array<Rgb, 3> there = linear_of(mesh.interpolant[k]);
    LightPiece piece;
    for (const auto& [c, channel] :
         {std::pair{0, &Rgb::x}, std::pair{1, &Rgb::y}, std::pair{2, &Rgb::z}}) {
      piece.corner[c] = mesh.vertices[t.vertex[c]];
      const auto [x, y] = place_in(e, piece.corner[c]);
      const auto u = float(x), v = float(y);
      const Rgb d = l.reflectance * (there[c] - linear_at(exact[t.leaf], e.corners, u, v));
      piece.radiosity[c] = max(linear_at(l.shining, e.corners, u, v) + d, Rgb{});
      l.bend = std::max({l.bend, max_component(d), max_component(-d)});
    }
    s.light.pieces.push_back(piece);
  }
}

/// Root mean square over the leaves.
double change_of(const Solution& s, std::span<const Rgb> before) {
  double squares = 0, area = 0;
  for (size_t e = 0; e < s.tree.elements.size(); ++e) {
    if (!s.tree.elements[e].is_leaf()) continue;
    const double d = double(luminance(s.light.elements[e].irradiance - before[e]));
    squares += s.tree.elements[e].area_m2 * d * d, area += s.tree.elements[e].area_m2;
  }
  return area > 0 ? std::sqrt(squares / area) : 0;
}

}  // namespace

std::array<Rgb, 3> linear_of(const Interpolant& r) {
  // With the weights L_k of the corners, the quadratic is the sum of its values at corners times
  // L_k (2 L_k - 1), and of those at the edges' middles times 4 L_i L_j. Over a triangle of area 1
  // the integral of L_1^a L_2^b L_3^c is 2 a! b! c! / (a + b + c + 2)!. So the moments with L_k are
  // 1/30 for the value at the corner k, -1/60 at the others, 2/15 at the middles of the edges
  // beside it and 1/15 opposite. The linear functions' mass matrix is 1/12 {{2, 1, 1}, ...}; its
  // inverse, by which moments are multiplied, has 9 on the diagonal and -3 beside it.
  const std::array<Rgb, 3> corner{value_of(r, 0, 0), value_of(r, 1, 0), value_of(r, 0, 1)};
  const std::array<Rgb, 3> opposite{value_of(r, 0.5f, 0.5f), value_of(r, 0, 0.5f),
                                    value_of(r, 0.5f, 0)};
  std::array<Rgb, 3> moment, out;
  for (size_t k = 0; k < 3; ++k)
    moment[k] =
        corner[k] * (1 / 30.0f) - (corner[(k + 1) % 3] + corner[(k + 2) % 3]) * (1 / 60.0f) +
        (opposite[(k + 1) % 3] + opposite[(k + 2) % 3]) * (2 / 15.0f) + opposite[k] * (1 / 15.0f);
  for (size_t k = 0; k < 3; ++k)
    out[k] = moment[k] * 9 - (moment[(k + 1) % 3] + moment[(k + 2) % 3]) * 3;
  return out;
}

Result<double> feed_back(Solution& s, const trace::RayTracer& tracer, const LightMesh& mesh,
                         Progress& progress) {
  if (!s.all_bounces) return 0.0;
  std::vector<Rgb> before;
  for (const ElementLight& l : s.light.elements) before.push_back(l.irradiance);
  // The defect becomes part of what no link brings; the links carry it on.
  const std::vector<std::array<Rgb, 4>> exact = correct(s, mesh);
  LUXEL_TRY_STATUS(iterate(s, tracer, kTolerance, progress));
  // Leaves get their triangles, for points near them.
  drop_pieces(s.light);
  add_pieces(s, mesh, exact);
  push_pull(s.faces, s.tree, s.light);
  return change_of(s, before);
}

}  // namespace luxel::hierarchical
