#include "luxel/solve/hierarchical/surface.h"

#include <algorithm>

namespace luxel::hierarchical {
namespace {

/// Faces whose normals differ by more from the one asked for are not meant.
constexpr double kAlike = 0.7;

Barycentric barycentric_in(const scene::Triangle3& t, Vec3 p) {
  const Vec3 e1 = t.b - t.a, e2 = t.c - t.a, d = p - t.a;
  const double a11 = double(dot(e1, e1)), a12 = double(dot(e1, e2)), a22 = double(dot(e2, e2));
  const double b1 = double(dot(e1, d)), b2 = double(dot(e2, d));
  const double det = a11 * a22 - a12 * a12;
  if (!(det > 0)) return {1.0f / 3, 1.0f / 3};
  const float u = std::clamp(float((a22 * b1 - a12 * b2) / det), 0.0f, 1.0f);
  return {u, std::clamp(float((a11 * b2 - a12 * b1) / det), 0.0f, 1 - u)};
}

/// The place of a convex face that is nearest to a point.
DVec3 nearest_place_on(const Face& face, DVec3 p) {
  const DVec3 n = face.plane.normal;
  const DVec3 foot = p - n * face.plane.height(p);
  if (depth_inside(face.corners, n, foot) >= 0) return foot;
  DVec3 best = face.corners.front();
  for (size_t k = 0; k < face.corners.size(); ++k) {
    const DVec3 a = face.corners[k], d = face.corners[(k + 1) % face.corners.size()] - a;
    const double t = std::clamp(dot(foot - a, d) / std::max(dot(d, d), 1e-30), 0.0, 1.0);
    if (const DVec3 q = a + d * t; length(q - p) < length(best - p)) best = q;
  }
  return best;
}

}  // namespace

std::optional<scene::SurfacePoint> solid_point(const Faces& faces, const trace::RayTracer& tracer,
                                               uint32_t face, DVec3 place) {
  const Vec3 normal = to_float(faces.faces[face].plane.normal);
  const auto reach = float(8 * faces.slack_m);
  const trace::Hit hit =
      tracer.closest_hit({to_float(place) + normal * reach, 0, -normal, 2 * reach});
  if (!hit.found() ||
      faces.face_of_triangle[faces.first_triangle[hit.instance] + hit.triangle] != face)
    return std::nullopt;
  return hit.point();
}

scene::SurfacePoint surface_point(const scene::Scene& scene, const Faces& faces,
                                  const trace::RayTracer& tracer, uint32_t face, DVec3 place) {
  const Face& f = faces.faces[face];
  if (!f.curved)
    if (const auto point = solid_point(faces, tracer, face, place)) return *point;
  const scene::Triangle3 t = scene::world_triangle(scene, f.instance, f.triangle);
  return {f.instance, f.triangle, barycentric_in(t, to_float(place))};
}

FacePoint face_point_of(const scene::Scene& scene, const Faces& faces,
                        const scene::SurfacePoint& p) {
  const uint32_t face = faces.face_of_triangle[faces.first_triangle[p.instance] + p.triangle];
  return {face, to_double(scene::world_position(scene, p))};
}

FacePoint nearest_face_point(const Faces& faces, DVec3 point, std::optional<DVec3> normal) {
  FacePoint best;
  double least_m = INFINITY;
  for (uint32_t f = 0; f < faces.size(); ++f) {
    const Face& face = faces.faces[f];
    if (normal && dot(face.plane.normal, *normal) < kAlike) continue;
    const DVec3 place = nearest_place_on(face, point);
    if (const double d = length(place - point); d < least_m) least_m = d, best = {f, place};
  }
  return best;
}

}  // namespace luxel::hierarchical
