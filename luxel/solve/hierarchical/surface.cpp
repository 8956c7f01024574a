#include "luxel/solve/hierarchical/surface.h"

#include <algorithm>

namespace luxel::hierarchical {
namespace {

Barycentric barycentric_in(const scene::Triangle3& t, Vec3 p) {
  const Vec3 e1 = t.b - t.a, e2 = t.c - t.a, d = p - t.a;
  const double a11 = double(dot(e1, e1)), a12 = double(dot(e1, e2)), a22 = double(dot(e2, e2));
  const double b1 = double(dot(e1, d)), b2 = double(dot(e2, d));
  const double det = a11 * a22 - a12 * a12;
  if (!(det > 0)) return {1.0f / 3, 1.0f / 3};
  const float u = std::clamp(float((a22 * b1 - a12 * b2) / det), 0.0f, 1.0f);
  return {u, std::clamp(float((a11 * b2 - a12 * b1) / det), 0.0f, 1 - u)};
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

}  // namespace luxel::hierarchical
