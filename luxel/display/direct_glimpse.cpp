#include "luxel/display/direct_glimpse.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/warp.h"
#include "luxel/scene/both_off_surface.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/surface_points.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr size_t kPointsOnEmitters = 16;
/// More lights than these are not looked at one by one: a view is chosen in a moment.
constexpr size_t kMostLights = 256;
/// Rays from a surface towards the surroundings.
constexpr int kSkyRays = 8;

/// side_seen_by(), its point a little above the surface: rays start there.
SeenSide start_above(const scene::Scene& scene, const trace::Ray& ray, const trace::Hit& hit) {
  SeenSide side = side_seen_by(scene, ray, hit);
  side.at = scene::off_surface(scene, hit.point(), side.normal);
  return side;
}

/// Towards a source, up to just before it; no direction where it does not shine.
trace::Ray towards(const Glimpse::Source& source, Vec3 from) {
  if (source.is_direction) return {from, 0, source.at, INFINITY};
  const Vec3 way = source.at - from;
  const bool behind = dot(source.normal, source.normal) > 0 && dot(source.normal, way) >= 0;
  const float distance = length(way);
  return {from, 0, behind ? Vec3{} : way / distance,
          both::reach_of_shadow_ray(distance, source.at)};
}

std::vector<scene::SurfacePoint> points_on_emitters(const scene::Scene& scene) {
  const auto shines = [](const scene::Scene& s, const scene::SurfacePoint& p) {
    return max_component(scene::material_at(s, p).emission) > 0;
  };
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      if (shines(scene, {i, t, {}}))
        return scene::points_uniform_in_area(scene, kPointsOnEmitters, 1, shines);
  return {};
}

/// All lights that shine; of more than kMostLights so many, spread evenly over the sum of what they
/// bring across the scene: none that brings a greater share is left out.
std::vector<const scene::PunctualLight*> some_lights(std::span<const scene::PunctualLight> lights,
                                                     float diagonal_m) {
  const auto brings = [&](const scene::PunctualLight& light) {
    const bool is_sun = light.kind == scene::PunctualLight::Kind::directional;
    const double power = double(max_component(light.intensity));
    return std::max(0.0, is_sun ? power * double(diagonal_m) * double(diagonal_m) : power);
  };
  std::vector<const scene::PunctualLight*> shining;
  double sum = 0;
  for (const scene::PunctualLight& light : lights)
    if (max_component(light.intensity) > 0) shining.push_back(&light), sum += brings(light);
  if (shining.size() <= kMostLights) return shining;
  std::vector<const scene::PunctualLight*> out;
  double before = 0;
  for (const scene::PunctualLight* light : shining) {
    const double after = before + brings(*light) * kMostLights / sum;
    if (std::floor(after) > std::floor(before)) out.push_back(light);
    before = after;
  }
  return out;
}

}  // namespace

SeenSide side_seen_by(const scene::Scene& scene, const trace::Ray& ray, const trace::Hit& hit) {
  const Vec3 front = scene::front_normal(scene, hit.instance, hit.triangle);
  return {scene::world_position(scene, hit.point()),
          dot(front, ray.direction) > 0 ? -front : front};
}

Glimpse glimpse_of(const scene::Scene& scene) {
  Glimpse out;
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  for (const scene::PunctualLight* light : some_lights(scene.lights, diagonal_m)) {
    const bool is_sun = light->kind == scene::PunctualLight::Kind::directional;
    out.sources.push_back({is_sun ? -light->direction : light->position, is_sun, {}});
  }
  for (const scene::SurfacePoint& p : points_on_emitters(scene)) {
    const bool both = scene::material_at(scene, p).double_sided;
    out.sources.push_back({scene::world_position(scene, p), false,
                           both ? Vec3{} : scene::front_normal(scene, p.instance, p.triangle)});
  }
  out.has_surroundings = max_component(scene.background) > 0 || !scene.environment.radiance.empty();
  return out;
}

std::vector<uint8_t> lit_by_sources(const scene::Scene& scene, const trace::RayTracer& tracer,
                                    const Glimpse& glimpse, std::span<const trace::Ray> rays,
                                    std::span<const trace::Hit> hits) {
  std::vector<trace::Ray> shadow;
  std::vector<size_t> of;  // a hit
  for (size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].found()) continue;
    const SeenSide seen = start_above(scene, rays[i], hits[i]);
    for (const Glimpse::Source& source : glimpse.sources) {
      const trace::Ray ray = towards(source, seen.at);
      if (!(dot(ray.direction, seen.normal) > 0)) continue;
      shadow.push_back(ray), of.push_back(i);
    }
  }
  std::vector<uint8_t> blocked(shadow.size()), lit(hits.size());
  tracer.occluded(shadow, blocked);
  for (size_t k = 0; k < of.size(); ++k) lit[of[k]] |= !blocked[k];
  return lit;
}

std::vector<uint8_t> lit_by_surroundings(const scene::Scene& scene, const trace::RayTracer& tracer,
                                         const Glimpse& glimpse, std::span<const trace::Ray> rays,
                                         std::span<const trace::Hit> hits) {
  if (!glimpse.has_surroundings) return std::vector<uint8_t>(hits.size());
  std::vector<trace::Ray> out;
  std::vector<size_t> of;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].found()) continue;
    const SeenSide seen = start_above(scene, rays[i], hits[i]);
    for (int k = 0; k < kSkyRays; ++k) {
      // Each hit has another turn of the same directions: many hits look everywhere.
      const Vec2 u{(float(k) + 0.5f) / kSkyRays,
                   std::fmod(0.618034f * float(k + 5 * int(i)), 1.0f)};
      out.push_back(
          {seen.at, 0, frame_around(seen.normal).to_world(cosine_hemisphere_sample(u)), INFINITY});
      of.push_back(i);
    }
  }
  std::vector<uint8_t> blocked(out.size()), lit(hits.size());
  tracer.occluded(out, blocked);
  for (size_t k = 0; k < of.size(); ++k) lit[of[k]] |= !blocked[k];
  return lit;
}

}  // namespace luxel::display
