#include "luxel/solve/hierarchical/blockers.h"

#include <algorithm>

namespace luxel::hierarchical {
namespace {

/// The cone from a point over a polygon, up to its plane. Planes face outwards.
viewfactor::Shaft cone_over(DVec3 point, PolygonView polygon, double slack_m) {
  viewfactor::Shaft shaft{{}, slack_m};
  Plane cover = viewfactor::plane_of(polygon);
  if (cover.height(point) > 0) cover = {-cover.normal, -cover.offset};
  shaft.planes.push_back(cover);
  const DVec3 middle = viewfactor::mean_corner(polygon);
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec3 across = cross(polygon[k] - point, polygon[(k + 1) % polygon.size()] - point);
    const double size = length(across);
    if (!(size > 0)) continue;
    Plane side{across * (1 / size), 0};
    side.offset = dot(side.normal, point);
    if (side.height(middle) > 0) side = {-side.normal, -side.offset};
    shaft.planes.push_back(side);
  }
  return shaft;
}

/// Faces that reach into a shaft, ascending.
void find_in(const Blockers& blockers, const viewfactor::Shaft& shaft,
             std::vector<uint32_t>& found) {
  viewfactor::polygons_near(blockers.tree, shaft, found);
  std::erase_if(found,
                [&](uint32_t k) { return viewfactor::is_outside(shaft, blockers.all[k].corners); });
}

}  // namespace

Blockers make_blockers(const Faces& faces) {
  Blockers out;
  out.slack_m = faces.slack_m;
  std::vector<Polygon> polygons;
  for (const Face& face : faces.faces) {
    out.all.push_back(viewfactor::make_blocker(face.corners));
    polygons.push_back(face.corners);
  }
  out.tree = viewfactor::build_polygon_tree(polygons);
  return out;
}

void filter_between(const Blockers& blockers, PolygonView a, PolygonView b,
                    std::span<const uint32_t> known, std::vector<uint32_t>& found) {
  const viewfactor::Shaft shaft = viewfactor::shaft_between(a, b, blockers.slack_m);
  found.clear();
  for (const uint32_t k : known)
    if (!viewfactor::is_outside(shaft, blockers.all[k].corners)) found.push_back(k);
}

void find_between(const Blockers& blockers, PolygonView a, PolygonView b,
                  std::vector<uint32_t>& found) {
  const viewfactor::Shaft shaft = viewfactor::shaft_between(a, b, blockers.slack_m);
  find_in(blockers, shaft, found);
}

void find_before(const Blockers& blockers, DVec3 point, PolygonView polygon,
                 std::vector<uint32_t>& found) {
  const viewfactor::Shaft shaft = cone_over(point, polygon, blockers.slack_m);
  find_in(blockers, shaft, found);
}

void find_near(const Blockers& blockers, PolygonView polygon, std::vector<uint32_t>& found) {
  viewfactor::Shaft box{{}, 0};
  for (const DVec3 axis : {DVec3{1, 0, 0}, DVec3{0, 1, 0}, DVec3{0, 0, 1}})
    for (const double side : {1.0, -1.0}) {
      double most = -INFINITY;
      for (const DVec3& p : polygon) most = std::max(most, dot(axis * side, p));
      box.planes.push_back({axis * side, most + 2 * blockers.slack_m});
    }
  viewfactor::polygons_near(blockers.tree, box, found);
}

void find_touching(const Blockers& blockers, DVec3 point, double slack_m,
                   std::vector<uint32_t>& found) {
  const std::array<DVec3, 1> there{point};
  find_near(blockers, there, found);
  std::erase_if(found, [&](uint32_t k) {
    const viewfactor::Blocker& b = blockers.all[k];
    return std::abs(b.plane.height(point)) > slack_m ||
           depth_inside(b.corners, b.plane.normal, point) < -slack_m;
  });
}

}  // namespace luxel::hierarchical
