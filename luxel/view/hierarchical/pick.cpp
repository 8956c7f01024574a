#include "luxel/view/hierarchical/pick.h"

#include <algorithm>
#include <cmath>

#include "luxel/solve/hierarchical/segments.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// Lines whose distances differ by less than this part of the reach lie one upon the other.
constexpr double kSameLine = 0.1;
/// Nearer to the eye than this part of a line's length nothing is projected.
constexpr double kNearEye = 1e-4;

Vec2 pixel_of_place(const trace::CameraRays& camera, DVec3 place) {
  const DVec3 to = place - to_double(camera.eye);
  const DVec3 right = to_double(camera.right), up = to_double(camera.up);
  const double scale = camera.orthographic ? 1 : dot(to, to_double(camera.forward));
  const double x = dot(to, right) / (dot(right, right) * scale);
  const double y = dot(to, up) / (dot(up, up) * scale);
  return {0.5f * camera.width * float(1 + x), 0.5f * camera.height * float(1 - y)};
}

}  // namespace

std::optional<h::FacePoint> face_point_seen(const SolutionView& view,
                                            const trace::CameraRays& camera, Vec2 pixel) {
  std::array rays{camera.through(pixel.x, pixel.y)};
  const trace::Hit hit = trace::visible_hits(view.scene, view.tracer, rays).front();
  if (!hit.found()) return std::nullopt;
  const h::FacePoint at = h::face_point_of(view.scene, view.solution.faces, hit.point());
  return at.face == h::kNone ? std::nullopt : std::optional(at);
}

std::vector<uint32_t> path_to(const SolutionView& view, const h::FacePoint& at) {
  const h::Tree& tree = view.solution.tree;
  // From the leaf up to its root.
  std::vector<uint32_t> up;
  auto element = uint32_t(h::leaf_at(tree, view.solution.faces, at.face, at.position));
  up.push_back(tree.id_of(element));
  while (tree.elements[element].parent != h::kNone)
    element = tree.elements[element].parent, up.push_back(tree.id_of(element));
  // From the first cluster down to that root, by its rank.
  std::vector<uint32_t> out;
  const uint32_t root = up.back();
  for (uint32_t id = 0; tree.is_cluster(id);) {
    out.push_back(id);
    const uint32_t rank = tree.rank[element];
    const auto holds = [&](uint32_t child) {
      if (!tree.is_cluster(child)) return child == root;
      return tree.clusters[child].first <= rank && rank < tree.clusters[child].end;
    };
    const auto& child = tree.clusters[id].child;
    id = holds(child[0]) ? child[0] : child[1];
  }
  out.insert(out.end(), up.rbegin(), up.rend());
  return out;
}

std::optional<uint32_t> triangle_at(const SolutionView& view, const h::FacePoint& at) {
  if (!view.mesh) return std::nullopt;
  const auto place = h::locate(view.solution, *view.mesh, at.face, at.position);
  return place ? std::optional(place->triangle) : std::nullopt;
}

DVec3 middle_of(const h::Tree& tree, uint32_t id) {
  return tree.is_cluster(id) ? tree.clusters[id].centre : tree.element(id).centre;
}

std::optional<std::array<Vec2, 2>> pixels_of(const trace::CameraRays& camera, DVec3 from,
                                             DVec3 to) {
  if (!camera.orthographic) {
    const auto ahead = [&](DVec3 p) {
      return dot(p - to_double(camera.eye), to_double(camera.forward));
    };
    h::Segment part{from, to};
    const double least = kNearEye * length(to - from);
    if (!h::clip_linear(part, ahead(from), ahead(to), std::max(least, 1e-9), INFINITY))
      return std::nullopt;
    from = part.a, to = part.b;
  }
  return std::array{pixel_of_place(camera, from), pixel_of_place(camera, to)};
}

float distance_to(const std::array<Vec2, 2>& line, Vec2 pixel) {
  const Vec2 along = line[1] - line[0], to = pixel - line[0];
  const float square = along.x * along.x + along.y * along.y;
  const float t =
      square > 0 ? std::clamp((to.x * along.x + to.y * along.y) / square, 0.0f, 1.0f) : 0;
  return length(to - along * t);
}

Nearness near_pixel(const trace::CameraRays& camera, Vec2 pixel) {
  return [camera, pixel](DVec3 from, DVec3 to) -> std::optional<double> {
    const auto line = pixels_of(camera, from, to);
    if (!line) return std::nullopt;
    return double(distance_to(*line, pixel) / kPickReach);
  };
}

Nearness near_place(DVec3 place, double reach_m) {
  return [place, reach_m](DVec3 from, DVec3 to) {
    const DVec3 along = to - from;
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(dot(place - from, along) / square, 0.0, 1.0) : 0;
    return std::optional(length(place - from - along * t) / reach_m);
  };
}

std::optional<LinkNumber> link_near(const SolutionView& view, std::span<const uint32_t> receivers,
                                    const Nearness& nearness) {
  const h::Tree& tree = view.solution.tree;
  std::optional<LinkNumber> out;
  double least = 1;
  for (const uint32_t receiver : receivers)
    for (uint32_t k = 0; k < view.solution.links.of[receiver].size(); ++k) {
      const h::Link& link = view.solution.links.of[receiver][k];
      const auto far = nearness(middle_of(tree, receiver), middle_of(tree, link.source));
      if (far && *far <= least) least = *far, out = LinkNumber{receiver, k};
    }
  return out;
}

std::optional<uint32_t> discontinuity_near(std::span<const h::Discontinuity> discontinuities,
                                           std::span<const double> weight,
                                           const Nearness& nearness) {
  std::vector<double> distance;
  double least = 1;
  for (const h::Discontinuity& d : discontinuities) {
    distance.push_back(nearness(d.a, d.b).value_or(INFINITY));
    least = std::min(least, distance.back());
  }
  std::optional<uint32_t> out;
  for (uint32_t k = 0; k < distance.size(); ++k)
    if (distance[k] <= 1 && distance[k] <= least + kSameLine && (!out || weight[k] > weight[*out]))
      out = k;
  return out;
}

}  // namespace luxel::view
