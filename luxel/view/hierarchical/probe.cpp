#include "luxel/view/hierarchical/probe.h"

#include <algorithm>

#include "luxel/view/hierarchical/selection_facts.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// Light at a point is off by less than this part of the scene's mean irradiance.
constexpr h::PointParams kProbePoint{.tolerance = 1e-6};
/// So far from a face's edge is a point that lies on it, over the way to the middle.
constexpr double kProbeInwards = 1e-5;

std::vector<SourceShare> shares_of(const SolutionView& view, const h::Receiver& at) {
  std::vector<SourceShare> out;
  for (const h::Seen& seen : h::sources_at(view.solution, view.tracer, at, kProbePoint)) {
    SourceShare share;
    share.face = seen.face, share.name = name_of_face(view, seen.face);
    share.form_factor = seen.visible, share.visible = seen.visible / seen.whole;
    share.irradiance = seen.irradiance;
    out.push_back(share);
  }
  return out;
}

/// A polygon in the plane of a face, as it is seen from the side of its front or its back.
std::vector<DVec2> flat(const h::FacePlane& plane, h::PolygonView polygon, double side) {
  std::vector<DVec2> out;
  for (const DVec3& p : polygon) {
    const DVec2 q = plane.to_plane(p);
    out.push_back({side * q.x, q.y});
  }
  return out;
}

SeenSource seen_source(const SolutionView& view, const h::Receiver& at, const SourceShare& share) {
  const h::Face& face = view.solution.faces.faces[share.face];
  SeenSource out;
  out.of = share, out.outline = face.corners;
  h::Backprojection back = h::backproject(view.solution, at, share.face);
  out.above = std::move(back.source), out.visible = std::move(back.visible);
  double visible_m2 = 0;
  for (const h::Polygon& part : out.visible) visible_m2 += viewfactor::area_m2(part);
  out.visible_area = visible_m2 / viewfactor::area_m2(face.corners);
  // From behind, left and right change places.
  const h::FacePlane plane = h::plane_coordinates(face);
  const double side = face.plane.height(at.position) < 0 ? -1 : 1;
  out.flat_outline = flat(plane, out.outline, side), out.flat_above = flat(plane, out.above, side);
  if (side < 0) std::reverse(out.flat_outline.begin(), out.flat_outline.end());
  for (const h::Polygon& part : out.visible) out.flat_visible.push_back(flat(plane, part, side));
  return out;
}

}  // namespace

h::Receiver receiver_of(const SolutionView& view, const h::FacePoint& at) {
  const h::Face& face = view.solution.faces.faces[at.face];
  DVec3 place = at.position;
  if (h::depth_inside(face.corners, face.plane.normal, place) < 4 * view.solution.faces.slack_m)
    place = place + (viewfactor::mean_corner(face.corners) - place) * kProbeInwards;
  return h::receiver_at(view.solution, view.scene, view.tracer, at.face, place);
}

Result<LightProbe> probe_light(const SolutionView& view, const h::FacePoint& at,
                               const ShownLight& shown, Progress& progress) {
  LightProbe out;
  out.at = at, out.name = name_of_face(view, at.face);
  const h::Receiver receiver = receiver_of(view, at);
  LUXEL_TRY(const std::vector<Rgb> exact, h::irradiance_at(view.solution, view.scene, view.tracer,
                                                           {&receiver, 1}, kProbePoint, progress));
  out.exact = out.from_no_face = exact[0], out.interpolated = shown(at);
  const auto all = double(luminance(out.exact));
  if (all > 0) out.difference = double(luminance(out.interpolated)) / all - 1;
  out.sources = shares_of(view, receiver);
  for (SourceShare& source : out.sources) {
    source.share = all > 0 ? double(luminance(source.irradiance)) / all : 0;
    out.from_no_face = max(Rgb{}, out.from_no_face - source.irradiance);
  }
  return out;
}

Result<BackprojectionProbe> probe_sources(const SolutionView& view, const h::FacePoint& at,
                                          size_t most_sources, Progress& progress) {
  BackprojectionProbe out;
  out.at = at;
  const h::Receiver receiver = receiver_of(view, at);
  std::vector<SourceShare> shares = shares_of(view, receiver);
  std::erase_if(shares, [](const SourceShare& s) { return !(max_component(s.irradiance) > 0); });
  double all = 0;
  for (const SourceShare& share : shares) all += double(luminance(share.irradiance));
  for (SourceShare& share : shares) {
    LUXEL_TRY_STATUS(stopped(progress));
    share.share = all > 0 ? double(luminance(share.irradiance)) / all : 0;
    if (out.sources.size() < most_sources)
      out.sources.push_back(seen_source(view, receiver, share));
    else
      ++out.left_out;
  }
  return out;
}

}  // namespace luxel::view
