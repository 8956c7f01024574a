#include "luxel/pipeline/bake/dark_lamps.h"

#include <fmt/format.h>

#include "luxel/base/parallel.h"
#include "luxel/base/spherical_harmonics.h"
#include "luxel/light/lights.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/sides.h"

namespace luxel::pipeline {
namespace {

/// Rays of a lamp, of which the first that finds a lit surface is the last.
constexpr uint32_t kRaysOfLamp = 256;
constexpr size_t kNamedLamps = 3;

using IsHidden = std::function<bool(const scene::SurfacePoint&)>;

/// The k-th direction of a lamp's rays, evenly within its cone.
Vec3 lamp_ray(const scene::PunctualLight& lamp, uint32_t k) {
  const Vec3 d = base::spiral_direction(k, kRaysOfLamp);
  if (!scene::has_cone(lamp.kind)) return d;
  // Areas of a sphere are those of its heights: the whole sphere is pressed into the cap.
  const float height = 1 - 0.5f * (1 - d.z) * (1 - std::cos(lamp.outer_cone_rad));
  const float stretch = std::sqrt((1 - height * height) / (1 - d.z * d.z));
  return frame_around(lamp.direction).to_world({d.x * stretch, d.y * stretch, height});
}

/// True where the back of a place has light: its own, or that of its front.
bool has_lit_back(const scene::Scene& scene, const scene::SurfacePoint& p) {
  return scene::reflects_from_behind(scene::material_at(scene, p)) ||
         scene::other_side_of(scene, p).has_value();
}

/// True where a lamp lights a place, as the solvers would have it.
bool is_lit_by(const scene::PunctualLight& lamp, const scene::Scene& scene,
               const trace::RayTracer& tracer, const scene::SurfacePoint& p) {
  Vec3 normal = scene::front_normal(scene, p.instance, p.triangle);
  if (dot(normal, lamp.position - scene::world_position(scene, p)) < 0) {
    if (!has_lit_back(scene, p)) return false;
    normal = -normal;
  }
  const Vec3 start = scene::off_surface(scene, p, normal);
  const light::PunctualIncidence in = light::incidence_at(lamp, scene.profiles, start);
  if (!(max_component(in.irradiance) > 0) || !(dot(in.towards, normal) > 0)) return false;
  const trace::Ray ray{start, 0, in.towards, in.reach_m};
  Rgb arriving;
  tracer.transmitted({&ray, 1}, {&arriving, 1});
  return max_component(arriving) > 0;
}

/// Why a lamp lights nothing; empty where it lights something, or may do so.
std::string why_dark(const scene::PunctualLight& lamp, const scene::Scene& scene,
                     const trace::RayTracer& tracer, const IsHidden& is_hidden, float diagonal_m) {
  if (!scene::has_position(lamp.kind) || !(max_component(lamp.intensity) > 0)) return {};
  const float step_m = 8 * scene::rounding_m(lamp.position, diagonal_m);
  trace::Hit nearest, nearest_back;
  for (uint32_t k = 0; k < kRaysOfLamp; ++k) {
    // Beyond the first surface there may be one that is lit, where the lamp lies a hair behind it.
    trace::Ray ray{lamp.position, step_m, lamp_ray(lamp, k), INFINITY};
    for (int passed = 0; passed < 2; ++passed) {
      const trace::Hit hit = tracer.closest_hit(ray);
      if (!hit.found()) break;
      if (is_lit_by(lamp, scene, tracer, hit.point()) && !is_hidden(hit.point())) return {};
      if (hit.t < nearest.t) nearest = hit;
      if (hit.back_face && !has_lit_back(scene, hit.point()) && hit.t < nearest_back.t)
        nearest_back = hit;
      ray.t_min = hit.t + step_m;
    }
  }
  const float range_m = lamp.range_m > 0 ? lamp.range_m : INFINITY;
  if (nearest_back.found() && nearest_back.t < range_m) {
    const float t = nearest_back.t;
    return fmt::format("it lies {} behind the front of '{}' (instance {}); move it out of there",
                       t < 0.5f ? fmt::format("{:.3g} mm", 1000 * t) : fmt::format("{:.3g} m", t),
                       scene.instances[nearest_back.instance].name, nearest_back.instance);
  }
  // One that meets nothing at all may shine at what is small and far away.
  if (!nearest.found() || nearest.t < range_m) return {};
  return fmt::format("no surface lies before it within its range of {:g} m", lamp.range_m);
}

}  // namespace

std::vector<std::string> about_dark_lamps(const scene::Scene& scene, const trace::RayTracer& tracer,
                                          const IsHidden& is_hidden) {
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<std::string> why(scene.lights.size()), out;
  parallel_for(why.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      why[i] = why_dark(scene.lights[i], scene, tracer, is_hidden, diagonal_m);
  });
  size_t dark = 0;
  for (size_t i = 0; i < why.size(); ++i) {
    if (why[i].empty() || ++dark > kNamedLamps) continue;
    const std::string& name = scene.lights[i].name;
    out.push_back(fmt::format("light {} lights nothing: {}",
                              name.empty() ? fmt::to_string(i) : fmt::format("'{}'", name),
                              why[i]));
  }
  if (dark > kNamedLamps)
    out.push_back(fmt::format("and {} more lights light nothing", dark - kNamedLamps));
  return out;
}

}  // namespace luxel::pipeline
