#include "luxel/view/edit/pick.h"

#include <array>
#include <cmath>

#include "luxel/trace/camera_rays.h"

namespace luxel::view {
namespace {

constexpr float kLeastVolume = 1e-30f;  ///< of a triangle and a ray beside it

/// World from object the other way round: for vectors of the world that become those of an object.
struct ToObject {
  explicit ToObject(const Mat34& m)
      : from(column(m, 3)),
        x(cross(column(m, 1), column(m, 2)) / determinant(m)),
        y(cross(column(m, 2), column(m, 0)) / determinant(m)),
        z(cross(column(m, 0), column(m, 1)) / determinant(m)) {}
  Vec3 vector(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3 point(Vec3 p) const { return vector(p - from); }
  Vec3 from, x, y, z;
};

/// Where a ray meets a triangle; not found where it does not.
trace::Hit triangle_hit(const trace::Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  trace::Hit out;
  const Vec3 ab = b - a, ac = c - a, p = cross(ray.direction, ac);
  const float volume = dot(ab, p);
  if (!(std::abs(volume) > kLeastVolume)) return out;
  const Vec3 to = ray.origin - a, q = cross(to, ab);
  const float u = dot(to, p) / volume, v = dot(ray.direction, q) / volume;
  const float t = dot(ac, q) / volume;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t > ray.t_min && t < ray.t_max)) return out;
  out.t = t, out.at = {u, v}, out.instance = 0;
  out.back_face = volume < 0;  // Counter-clockwise in the object is the front, mirrored or not.
  return out;
}

bool is_seen(const scene::Scene& scene, const trace::Hit& hit) {
  const scene::Material& material = scene::material_at(scene, hit.point());
  return (!hit.back_face || material.double_sided) && scene::is_solid_at(scene, hit.point());
}

bool has_moved(const EditDesk& desk, uint32_t instance) {
  return desk.now.world_from_object[instance] !=
         desk.read->scene.instances[instance].world_from_object;
}

/// Sets `nearest` to the hit on an instance that has moved, where that is nearer.
void try_moved(const EditDesk& desk, uint32_t instance, trace::Ray ray, trace::Hit& nearest) {
  const scene::Scene& scene = desk.read->scene;
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  const ToObject to_object(desk.now.world_from_object[instance]);
  ray.origin = to_object.point(ray.origin), ray.direction = to_object.vector(ray.direction);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    trace::Hit hit = triangle_hit(ray, mesh.positions[a], mesh.positions[b], mesh.positions[c]);
    hit.triangle = t;
    if (!hit.found() || hit.t >= nearest.t) continue;
    hit.instance = instance;
    if (is_seen(scene, hit)) nearest = hit;
  }
}

/// The first hit of a ray among instances that are where they were.
trace::Hit unmoved_hit(const EditDesk& desk, const trace::Ray& ray) {
  std::array rays{ray};
  for (int step = 0; step < trace::kMostSurfaces; ++step) {
    const trace::Hit hit = trace::visible_hits(desk.read->scene, *desk.read->tracer, rays).front();
    if (!hit.found() || !has_moved(desk, hit.instance)) return hit;
    trace::go_on_behind(hit, rays[0]);
  }
  return {};
}

}  // namespace

trace::Hit visible_now(const EditDesk& desk, const trace::Ray& ray) {
  trace::Hit nearest = unmoved_hit(desk, ray);
  for (uint32_t i = 0; i < desk.now.world_from_object.size(); ++i)
    if (has_moved(desk, i)) try_moved(desk, i, ray, nearest);
  return nearest;
}

std::optional<scene::SurfacePoint> surface_seen_now(const EditDesk& desk, const Frame& frame,
                                                    Vec2 pixel, int width, int height) {
  const trace::CameraRays rays(frame.camera, width, height);
  const trace::Hit hit = visible_now(desk, rays.through(pixel.x, pixel.y));
  return hit.found() ? std::optional(hit.point()) : std::nullopt;
}

Box3 placed_bounds(const scene::Mesh& mesh, const Mat34& world_from_object) {
  Box3 out;
  for (const Vec3& p : mesh.positions) out.extend(transform_point(world_from_object, p));
  return out;
}

Box3 object_bounds(const scene::Scene& scene, uint32_t instance) {
  Box3 out;
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  for (const std::array<uint32_t, 3>& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) out.extend(mesh.positions[corner]);
  return out;
}

}  // namespace luxel::view
