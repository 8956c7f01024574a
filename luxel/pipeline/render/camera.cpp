#include "luxel/pipeline/render/camera.h"

#include <cmath>

#include "luxel/display/draw.h"

namespace luxel::pipeline {
namespace {

scene::Camera camera_at(Vec3 eye, Vec3 look_at, float fov_y_rad) {
  const Vec3 back = normalize(eye - look_at);
  const Vec3 up = std::abs(back.y) > 0.999f ? Vec3{0, 0, -1} : Vec3{0, 1, 0};
  const Vec3 right = normalize(cross(up, back));
  scene::Camera camera;
  camera.name = "eye";
  camera.world_from_camera = from_columns(right, cross(back, right), back, eye);
  camera.fov_y_rad = fov_y_rad;
  return camera;
}

}  // namespace

Result<scene::Camera> choose_camera(const CameraChoice& choice, const scene::Scene& scene,
                                    const trace::RayTracer& tracer, const std::string& file) {
  if (choice.eye) {
    if (*choice.eye == choice.look_at)
      return fail(ErrorCode::bad_setting, "--eye and --look-at are the same point");
    return camera_at(*choice.eye, choice.look_at, float(choice.fov_deg) * kPi / 180);
  }
  std::string names;
  for (const scene::Camera& camera : scene.cameras) {
    if (choice.name.empty() || camera.name == choice.name) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (!choice.name.empty())
    return fail(ErrorCode::bad_setting, "{} {} is not in {}; there is: {}", choice.asked,
                choice.name, file, names.empty() ? "none" : names);
  return display::fit_camera(scene, tracer, choice.aspect);
}

}  // namespace luxel::pipeline
