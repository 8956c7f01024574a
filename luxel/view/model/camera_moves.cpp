#include "luxel/view/model/camera_moves.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::view {
namespace {

constexpr Vec3 kVertical{0, 1, 0};
constexpr float kSteepest = 89 * kPi / 180;

struct Axes {
  Vec3 right, up, back, eye;
};

Axes axes_of(const scene::Camera& camera) {
  const Mat34& m = camera.world_from_camera;
  return {normalize(column(m, 0)), normalize(column(m, 1)), normalize(column(m, 2)), column(m, 3)};
}

scene::Camera with_axes(scene::Camera camera, const Axes& a) {
  camera.world_from_camera = from_columns(a.right, a.up, a.back, a.eye);
  return camera;
}

/// Counter-clockwise where the unit `axis` points at the viewer. (Rodrigues' formula)
Vec3 rotated(Vec3 v, Vec3 axis, float angle) {
  const float c = std::cos(angle);
  return v * c + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1 - c));
}

void rotate(Axes& a, Vec3 axis, float angle) {
  a.right = normalize(rotated(a.right, axis, angle));
  a.up = normalize(rotated(a.up, axis, angle));
  a.back = normalize(rotated(a.back, axis, angle));
}

/// The axes turned by `aside` about the vertical, `back` raised by `up` as far as it may be.
void turn_axes(Axes& a, float aside, float up) {
  const float elevation = std::asin(std::clamp(a.back.y, -1.0f, 1.0f));
  // A camera that looks straight down may stay as it is.
  const float most = std::max(kSteepest, std::abs(elevation));
  const float raised = std::clamp(elevation + up, -most, most) - elevation;
  const Vec3 level = cross(kVertical, a.back);
  rotate(a, length(level) > 1e-4f ? normalize(level) : a.right, -raised);
  rotate(a, kVertical, aside);
}

}  // namespace

scene::Camera orbited(const scene::Camera& camera, Vec3 target, float aside, float up) {
  Axes a = axes_of(camera);
  const Vec3 from_target = a.eye - target;
  const Vec3 in_axes{dot(from_target, a.right), dot(from_target, a.up), dot(from_target, a.back)};
  turn_axes(a, aside, up);
  a.eye = target + a.right * in_axes.x + a.up * in_axes.y + a.back * in_axes.z;
  return with_axes(camera, a);
}

scene::Camera turned(const scene::Camera& camera, float aside, float up) {
  Axes a = axes_of(camera);
  turn_axes(a, aside, -up);
  return with_axes(camera, a);
}

scene::Camera panned(const scene::Camera& camera, Vec3 target, Vec2 by, float aspect) {
  Axes a = axes_of(camera);
  const bool is_parallel = camera.orthographic_height_m > 0;
  const float ahead = dot(a.eye - target, a.back);
  const float distance = is_parallel ? 1 : ahead > 0 ? ahead : length(a.eye - target);
  const float height = 2 * trace::half_height(camera, aspect) * distance;
  a.eye = a.eye - a.right * (by.x * height) + a.up * (by.y * height);
  return with_axes(camera, a);
}

scene::Camera approached(const scene::Camera& camera, Vec3 place, float factor) {
  LUXEL_CHECK(factor > 0);
  Axes a = axes_of(camera);
  Vec3 towards = (place - a.eye) * (1 - factor);
  scene::Camera out = camera;
  out.orthographic_height_m *= factor;
  // Parallel rays show the same from nearer; the eye stays before what it sees.
  if (camera.orthographic_height_m > 0) towards += a.back * -dot(towards, a.back);
  a.eye += towards;
  return with_axes(out, a);
}

scene::Camera flown(const scene::Camera& camera, Vec3 right_up_ahead) {
  Axes a = axes_of(camera);
  a.eye += a.right * right_up_ahead.x + kVertical * right_up_ahead.y - a.back * right_up_ahead.z;
  return with_axes(camera, a);
}

scene::Camera framed(const scene::Camera& camera, const Box3& box, float aspect) {
  LUXEL_CHECK(!box.empty() && aspect > 0);
  Axes a = axes_of(camera);
  scene::Camera out = camera;
  const float radius = std::max(0.5f * box.diagonal(), 1e-6f);
  const float narrow = std::min(1.0f, aspect);  // of the half height: the half width may be less
  if (camera.orthographic_height_m > 0) {
    out.orthographic_height_m *= radius / (trace::half_height(camera, aspect) * narrow);
    a.eye = box.centre() + a.back * (2 * radius);
  } else {
    const float half_angle = std::atan(trace::half_height(camera, aspect) * narrow);
    a.eye = box.centre() + a.back * (radius / std::sin(half_angle));
  }
  return with_axes(out, a);
}

}  // namespace luxel::view
