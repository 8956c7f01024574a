#include "luxel/view/hierarchical/curve.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/solve/hierarchical/segments.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// Root mean square and maximum of the difference's luminance.
struct Errors {
  double rms = 0, most = 0, mean = 0;  ///< mean of the exact one
};
Errors errors_of(std::span<const Rgb> exact, std::span<const Rgb> shown) {
  Errors out;
  for (size_t k = 0; k < exact.size(); ++k) {
    const auto e = double(luminance(exact[k])), d = double(luminance(shown[k])) - e;
    out.rms += d * d, out.mean += e;
    out.most = std::max(out.most, std::abs(d));
  }
  const auto count = double(std::max<size_t>(exact.size(), 1));
  out.rms = std::sqrt(out.rms / count), out.mean /= count;
  return out;
}

Result<std::vector<Rgb>> exact_at(const SolutionView& view, uint32_t face,
                                  std::span<const DVec3> places, const h::PointParams& point,
                                  Progress& progress) {
  std::vector<h::Receiver> receivers;
  for (const DVec3& place : places) receivers.push_back(receiver_of(view, {face, place}));
  return h::irradiance_at(view.solution, view.scene, view.tracer, receivers, point, progress);
}

std::vector<Rgb> shown_at(uint32_t face, std::span<const DVec3> places, const ShownLight& shown) {
  std::vector<Rgb> out;
  for (const DVec3& place : places) out.push_back(shown({face, place}));
  return out;
}

/// Both ends in the middle of a polygon, drawn apart along a direction until its borders.
CurveLine through(h::PolygonView polygon, uint32_t face, DVec3 middle, DVec3 direction,
                  double reach_m) {
  const DVec3 d = normalize(direction) * reach_m;
  h::Segment line{middle - d, middle + d};
  if (!h::clip_to(polygon, viewfactor::plane_of(polygon).normal, line)) line = {middle, middle};
  return {face, line.a, line.b};
}

}  // namespace

Result<Curve> curve_along(const SolutionView& view, const CurveLine& line, const ShownLight& shown,
                          const CurveParams& params, Progress& progress) {
  Curve out;
  out.line = line;
  std::vector<DVec3> places;
  for (size_t k = 0; k < params.points; ++k) {
    const double t = (double(k) + 0.5) / double(params.points);
    places.push_back(line.from + (line.to - line.from) * t);
    out.at_m.push_back(float(t * length(line.to - line.from)));
  }
  LUXEL_TRY(out.exact, exact_at(view, line.face, places, params.point, progress));
  out.shown = shown_at(line.face, places, shown);
  const Errors errors = errors_of(out.exact, out.shown);
  out.rms = errors.rms, out.most = errors.most;
  out.relative_rms = errors.mean > 0 ? errors.rms / errors.mean : 0;
  return out;
}

std::optional<CurveLine> clipped(const SolutionView& view, const CurveLine& line) {
  const h::Face& face = view.solution.faces.faces[line.face];
  const auto on_plane = [&](DVec3 p) { return p - face.plane.normal * face.plane.height(p); };
  h::Segment part{on_plane(line.from), on_plane(line.to)};
  if (!h::clip_to(face.corners, face.plane.normal, part)) return std::nullopt;
  if (!(length(part.b - part.a) > view.solution.faces.slack_m)) return std::nullopt;
  return CurveLine{line.face, part.a, part.b};
}

CurveLine line_across(h::PolygonView polygon, uint32_t face) {
  DVec3 longest;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec3 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
    if (length(edge) > length(longest)) longest = edge;
  }
  const DVec3 middle = viewfactor::mean_corner(polygon);
  return through(polygon, face, middle, longest, 2 * viewfactor::radius_about(middle, polygon));
}

std::optional<CurveLine> line_across(const SolutionView& view, uint32_t face,
                                     const h::Discontinuity& line, double reach_m) {
  const h::Face& f = view.solution.faces.faces[face];
  const CurveLine out = through(f.corners, face, (line.a + line.b) * 0.5,
                                cross(f.plane.normal, line.b - line.a), reach_m);
  return clipped(view, out);
}

Result<LightSurface> surface_over(const SolutionView& view, h::PolygonView polygon, uint32_t face,
                                  size_t cells, const ShownLight& shown,
                                  const h::PointParams& point, Progress& progress) {
  const auto corners = uint32_t(polygon.size());
  LUXEL_CHECK(corners == 3 || corners == 4);
  std::array<DVec3, 4> corner{};
  std::copy(polygon.begin(), polygon.end(), corner.begin());
  LightSurface out;
  out.face = face;
  std::vector<uint32_t> row_before;
  for (size_t j = 0; j <= cells; ++j) {
    const size_t count = corners == 3 ? cells - j : cells;
    std::vector<uint32_t> row;
    for (size_t i = 0; i <= count; ++i) {
      row.push_back(uint32_t(out.places.size()));
      out.places.push_back(
          h::linear_at(corner, corners, double(i) / double(cells), double(j) / double(cells)));
      if (i > 0) out.edges.push_back({row[i - 1], row[i]});
      if (j > 0) out.edges.push_back({row_before[i], row[i]});
    }
    row_before = std::move(row);
  }
  LUXEL_TRY(out.exact, exact_at(view, face, out.places, point, progress));
  out.shown = shown_at(face, out.places, shown);
  const Errors errors = errors_of(out.exact, out.shown);
  out.rms = errors.rms, out.most = errors.most;
  return out;
}

ShownLight light_of_leaves(const SolutionView& view) {
  return [view](const h::FacePoint& at) {
    const h::Solution& s = view.solution;
    return s.light.elements[h::leaf_at(s.tree, s.faces, at.face, at.position)].irradiance;
  };
}

ShownLight linear_light(const SolutionView& view) {
  return [view](const h::FacePoint& at) -> Rgb {
    const auto place = h::locate(view.solution, *view.mesh, at.face, at.position);
    if (!place) return {};
    const h::Interpolant& r = view.mesh->interpolant[place->triangle];
    return h::value_of(r, 0, 0) * (1 - place->s - place->t) + h::value_of(r, 1, 0) * place->s +
           h::value_of(r, 0, 1) * place->t;
  };
}

ShownLight quadratic_light(const SolutionView& view) {
  return [view](const h::FacePoint& at) -> Rgb {
    const auto place = h::locate(view.solution, *view.mesh, at.face, at.position);
    if (!place) return {};
    return max(Rgb{}, h::value_of(view.mesh->interpolant[place->triangle], place->s, place->t));
  };
}

std::vector<std::string> lines_of(const Curve& curve, const std::string& unit) {
  return {fmt::format("{:.3g} m, {} points", length(curve.line.to - curve.line.from),
                      curve.exact.size()),
          fmt::format("RMS of the difference {:.3g} {}, {:.3g} %", curve.rms, unit,
                      100 * curve.relative_rms),
          fmt::format("largest difference {:.3g} {}", curve.most, unit)};
}

}  // namespace luxel::view
