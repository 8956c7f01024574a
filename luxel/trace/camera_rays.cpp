#include "luxel/trace/camera_rays.h"

#include <cmath>

#include "luxel/base/check.h"

namespace luxel::trace {

float half_height(const scene::Camera& camera, float aspect) {
  const float own = camera.orthographic_height_m > 0 ? 0.5f * camera.orthographic_height_m
                                                     : std::tan(0.5f * camera.fov_y_rad);
  return camera.aspect > aspect ? own * (camera.aspect / aspect) : own;
}

CameraRays::CameraRays(const scene::Camera& camera, int width_px, int height_px)
    : orthographic(camera.orthographic_height_m > 0),
      width(float(width_px)),
      height(float(height_px)) {
  const float aspect = width / height;
  const float to_edge = half_height(camera, aspect);
  // A node may scale its camera; glTF ignores that, so only the axes' directions count.
  const Mat34& m = camera.world_from_camera;
  eye = {m.row[0][3], m.row[1][3], m.row[2][3]};
  right = normalize(column(m, 0)) * (to_edge * aspect);
  up = normalize(column(m, 1)) * to_edge;
  forward = -normalize(column(m, 2));
}

Ray CameraRays::through(float x, float y) const {
  const Vec3 aside = right * (2 * x / width - 1) + up * (1 - 2 * y / height);
  if (orthographic) return {.origin = eye + aside, .direction = forward};
  return {.origin = eye, .direction = normalize(forward + aside)};
}

Vec2 CameraRays::pixel_of(Vec3 place) const {
  const Vec3 to_place = place - eye;
  const float ahead = orthographic ? 1 : dot(to_place, forward);
  return {(dot(to_place, right) / (dot(right, right) * ahead) + 1) * width / 2,
          (1 - dot(to_place, up) / (dot(up, up) * ahead)) * height / 2};
}

bool faces(const CameraRays& camera, Vec3 place, Vec3 normal) {
  const Vec3 to_place = place - camera.eye;
  if (dot(normal, camera.orthographic ? camera.forward : to_place) >= 0) return false;
  const float ahead = dot(to_place, camera.forward);
  if (!camera.orthographic && ahead <= 0) return false;
  const float reach = camera.orthographic ? 1 : ahead;
  return std::abs(dot(to_place, camera.right)) <= reach * dot(camera.right, camera.right) &&
         std::abs(dot(to_place, camera.up)) <= reach * dot(camera.up, camera.up);
}

bool is_unseen_back(const scene::Scene& scene, const Hit& hit) {
  return hit.found() && hit.back_face && !material_at(scene, hit.point()).double_sided;
}

void go_on_behind(const Hit& hit, Ray& ray) {
  // By more than the rounding of t between packets and single rays.
  ray.t_min = std::max(hit.t * (1 + 4e-7f), 1e-20f);
}

std::vector<Hit> visible_hits(const scene::Scene& scene, const RayTracer& tracer,
                              std::span<Ray> rays) {
  std::vector<Hit> hits(rays.size());
  tracer.closest_hits(rays, hits, Packets::bundles);
  std::vector<size_t> open;
  for (size_t i = 0; i < hits.size(); ++i)
    if (is_unseen_back(scene, hits[i])) open.push_back(i);

  std::vector<Ray> on;
  std::vector<Hit> next;
  for (int step = 1; step < kMostSurfaces && !open.empty(); ++step) {
    on.clear();
    for (const size_t i : open) {
      go_on_behind(hits[i], rays[i]);
      on.push_back(rays[i]);
    }
    next.resize(on.size());
    tracer.closest_hits(on, next);
    std::vector<size_t> still_open;
    for (size_t k = 0; k < open.size(); ++k) {
      hits[open[k]] = next[k];
      if (is_unseen_back(scene, next[k])) still_open.push_back(open[k]);
    }
    open = std::move(still_open);
  }
  for (const size_t i : open) hits[i] = {};
  return hits;
}

}  // namespace luxel::trace
