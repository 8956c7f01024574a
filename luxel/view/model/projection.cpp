#include "luxel/view/model/projection.h"

#include <algorithm>

#include "luxel/trace/camera_rays.h"

namespace luxel::view {
namespace {

constexpr float kSmallestAngle = 1e-4f;  ///< the square of its sine

trace::CameraRays rays_of(const Walk& walk) { return {walk.shown.camera, walk.width, walk.height}; }

}  // namespace

std::optional<Vec2> pixel_of(const Walk& walk, Vec3 place) {
  const trace::CameraRays rays = rays_of(walk);
  const Vec3 to = place - rays.eye;
  const float ahead = dot(to, rays.forward);
  if (!(ahead > 0)) return std::nullopt;
  const float scale = rays.orthographic ? 1 : ahead;
  const float x = dot(to, rays.right) / (dot(rays.right, rays.right) * scale);
  const float y = dot(to, rays.up) / (dot(rays.up, rays.up) * scale);
  return Vec2{0.5f * float(walk.width) * (1 + x), 0.5f * float(walk.height) * (1 - y)};
}

trace::Ray ray_through(const Walk& walk, Vec2 pixel) {
  return rays_of(walk).through(pixel.x, pixel.y);
}

Vec3 forward_of(const Walk& walk) { return normalize(rays_of(walk).forward); }

float metres_per_pixel(const Walk& walk, Vec3 place) {
  const trace::CameraRays rays = rays_of(walk);
  const float scale = rays.orthographic ? 1 : dot(place - rays.eye, rays.forward);
  return std::max(scale, 0.0f) * 2 * length(rays.up) / float(walk.height);
}

Vec3 on_plane(const trace::Ray& ray, Vec3 place, Vec3 normal) {
  return ray.origin +
         ray.direction * (dot(place - ray.origin, normal) / dot(ray.direction, normal));
}

Vec3 on_line(const trace::Ray& ray, Vec3 place, Vec3 axis) {
  const Vec3 d = ray.direction, w = place - ray.origin;
  const float b = dot(axis, d), square = 1 - b * b;  // of the sine between them
  if (square < kSmallestAngle) return place;
  return place + axis * ((b * dot(d, w) - dot(axis, w)) / square);
}

}  // namespace luxel::view
