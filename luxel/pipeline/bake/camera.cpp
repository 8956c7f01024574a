#include "luxel/pipeline/bake/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "luxel/display/fit_camera.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/held_range.h"
#include "luxel/scene/origin.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::pipeline {
namespace {

using display::Viewpoint;

struct NamedViewpoint {
  std::string_view name;
  Viewpoint from;
};
constexpr std::array kViewpoints{NamedViewpoint{"interior", Viewpoint::interior},
                                 NamedViewpoint{"exterior", Viewpoint::exterior},
                                 NamedViewpoint{"front", Viewpoint::front},
                                 NamedViewpoint{"top", Viewpoint::top}};

std::optional<Viewpoint> viewpoint_of(std::string_view word) {
  for (const NamedViewpoint& known : kViewpoints)
    if (known.name == word) return known.from;
  return std::nullopt;
}

std::string camera_names(const scene::Scene& scene) {
  std::string names;
  for (const scene::Camera& camera : scene.cameras)
    names += (names.empty() ? "" : ", ") + camera.name;
  return names.empty() ? "none" : names;
}

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

/// The scene's own, by name; nullptr when there is none of it.
const scene::Camera* find_camera(const scene::Scene& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.cameras, name, &scene::Camera::name);
  return found == scene.cameras.end() ? nullptr : &*found;
}

bool is_flat(const scene::Scene& scene, std::span<const trace::Hit> hits) {
  Vec3 sum{};
  for (const trace::Hit& hit : hits) {
    const Vec3 n = scene::front_normal(scene, hit.instance, hit.triangle);
    sum += dot(n, sum) < 0 ? -n : n;
  }
  return length(sum) > 0.999f * float(hits.size());
}

/// Why a picture of a file's camera shows nothing; empty: it shows something.
std::string why_blind(const scene::Scene& scene, const scene::Camera& camera, Outlook outlook) {
  constexpr float kArm_m = 0.75f;
  constexpr double kNearlyAll = 0.9;
  // Parts of the scene's diagonal: cameras close to small things, and to walls of rooms.
  constexpr float kTooNear = 0.02f, kBeforeAWall = 0.1f;
  std::vector<trace::Hit>& seen = outlook.seen;
  const size_t rays = seen.size();
  std::erase_if(seen, [](const trace::Hit& hit) { return !hit.found(); });
  if (seen.empty())
    return std::ranges::any_of(outlook.first, &trace::Hit::found) ? "shows no front of a surface"
                                                                  : "shows no surface";
  if (camera.orthographic_height_m > 0 || double(seen.size()) < kNearlyAll * double(rays))
    return {};
  const auto at = seen.begin() + std::ptrdiff_t(kNearlyAll * double(rays));
  std::ranges::nth_element(seen, at, {}, &trace::Hit::t);
  const float farthest = at->t, diagonal = scene::world_bounds(scene).diagonal();
  const bool is_near = farthest < std::min(kArm_m, kTooNear * diagonal);
  if (!is_near && !(farthest < std::min(kArm_m, kBeforeAWall * diagonal) && is_flat(scene, seen)))
    return {};
  return fmt::format("looks at a wall {:.2g} m away", std::ranges::min(seen, {}, &trace::Hit::t).t);
}

/// The first camera of the file, or a fitted one.
scene::Camera usual_camera(const scene::Scene& scene, const trace::RayTracer& tracer, float aspect,
                           std::vector<std::string>* warnings) {
  if (scene.cameras.empty()) return display::fit_camera(scene, tracer, aspect);
  const scene::Camera& first = scene.cameras.front();
  const float own = first.aspect > 0 ? first.aspect : aspect;
  const std::string why = why_blind(scene, first, outlook_of(scene, tracer, first, own));
  if (why.empty()) return first;
  if (warnings)
    warnings->push_back(fmt::format(
        "camera '{}' of the file {}, so the picture is taken from a fitted view; --view {} shows "
        "the file's",
        first.name, why, first.name));
  return display::fit_camera(scene, tracer, aspect);
}

}  // namespace

Outlook outlook_of(const scene::Scene& scene, const trace::RayTracer& tracer,
                   const scene::Camera& camera, float aspect) {
  constexpr int kRows = 48;
  const int columns = std::clamp(int(float(kRows) * aspect), 8, 4 * kRows);
  const trace::CameraRays through(camera, columns, kRows);
  std::vector<trace::Ray> rays;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < columns; ++x)
      rays.push_back(through.through(float(x) + 0.5f, float(y) + 0.5f));
  Outlook out;
  out.first.resize(rays.size());
  tracer.closest_hits(rays, out.first);
  out.seen = trace::visible_hits(scene, tracer, rays);
  return out;
}

std::string viewpoint_names() { return "interior, exterior, front or top"; }

Status check_view(const std::string& view, const scene::Scene& scene, const std::string& file) {
  if (view.empty() || viewpoint_of(view) || find_camera(scene, view)) return {};
  return fail(ErrorCode::bad_setting, "--view {} is neither {} nor a camera of {}; its cameras: {}",
              view, viewpoint_names(), file, camera_names(scene));
}

Result<scene::Camera> choose_camera(const CameraChoice& choice, const scene::Scene& scene,
                                    const trace::RayTracer& tracer, const std::string& file,
                                    std::vector<std::string>* warnings) {
  if (choice.eye) {
    const Vec3 eye = scene::in_scene(scene, *choice.eye),
               look_at = scene::in_scene(scene, choice.look_at);
    if (!scene::has_unit_vector(eye - look_at))
      return fail(ErrorCode::bad_setting, "--eye and --look-at are the same point");
    return camera_at(eye, look_at, float(choice.fov_deg) * kPi / 180);
  }
  LUXEL_TRY_STATUS(check_view(choice.view, scene, file));
  if (const auto from = viewpoint_of(choice.view))
    return display::fit_camera(scene, tracer, choice.aspect, *from);
  const std::string& name = choice.view.empty() ? choice.name : choice.view;
  if (name.empty()) return usual_camera(scene, tracer, choice.aspect, warnings);
  if (const scene::Camera* camera = find_camera(scene, name)) return *camera;
  return fail(ErrorCode::bad_setting, "{} {} is not in {}; its cameras: {}", choice.asked, name,
              file, camera_names(scene));
}

Status check_picture(const scene::Scene& scene, const trace::RayTracer& tracer,
                     const scene::Camera& camera, const image::Image& picture) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      if (scene::is_held_light(picture.rgb(x, y))) continue;
      const trace::CameraRays rays(camera, picture.width, picture.height);
      const trace::Ray ray = rays.through(float(x) + 0.5f, float(y) + 0.5f);
      const trace::Hit hit = tracer.closest_hit(ray);
      return Failure{scene::overflow_at(
          scene, hit.found() ? scene::world_position(scene, hit.point()) : ray.origin)};
    }
  return {};
}

}  // namespace luxel::pipeline
