#include "luxel/pipeline/settings/needs_day.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/direct_light.h"
#include "luxel/scene/surface_points.h"
#include "luxel/transport/back_faces.h"

namespace luxel::pipeline {
namespace {

constexpr size_t kSeenPlaces = 1024, kLeastSeenPlaces = 16;
constexpr int kRaysOfDay = 16;
constexpr uint32_t kOpenRays = 8;
/// Radiance below which a white surface is black. Emission is in nits by glTF's specification, and
/// viewers show 1 as white: invisible in either reading. It is no part of what emits, because a
/// bulb is ten thousand times brighter than the wall that it lights well.
constexpr float kFaintRadiance = 0.01f;
constexpr double kMostlyBlack = 0.9, kOpenOfBlack = 0.5;

/// Places that can be seen, evenly over all surfaces, and what they shine by themselves.
struct SeenPlaces {
  transport::Elements elements;
  std::vector<Rgb> emission;
};

SeenPlaces seen_places(const scene::Scene& scene, const trace::RayTracer& tracer) {
  SeenPlaces out;
  bool from_behind = false;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(scene, kSeenPlaces, 1)) {
    const scene::Material& material = scene::material_at(scene, p);
    if (!scene::is_solid_at(scene, p)) continue;
    // The two sides of a thin surface in turn.
    from_behind = material.double_sided && !from_behind;
    const transport::SmoothPoint at = transport::smooth_point(scene, p, from_behind ? -1.0f : 1.0f);
    if (!transport::is_in_the_open(scene, tracer, at.start, at.geometric_normal)) continue;
    out.elements.position.push_back(at.start), out.elements.normal.push_back(at.normal);
    out.elements.geometric_normal.push_back(at.geometric_normal);
    out.elements.reflectance.push_back({});
    out.emission.push_back(material.unlit ? Rgb{1, 1, 1} : scene::emission_at(scene, p));
  }
  return out;
}

bool sees_the_open(const trace::RayTracer& tracer, const SeenPlaces& places, size_t i) {
  std::vector<trace::Ray> rays;
  const Frame frame = frame_around(places.elements.geometric_normal[i]);
  for (uint32_t k = 0; k < kOpenRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, hash64(2, i))));
    rays.push_back({places.elements.position[i], 0, d, INFINITY});
  }
  std::vector<uint8_t> blocked(rays.size());
  tracer.occluded(rays, blocked);
  return std::ranges::count(blocked, 0) > 0;
}

/// "'badge'", "'badge', 2 more materials": the first that emit.
std::string names_of_emitters(const scene::Scene& scene) {
  std::set<uint32_t> found;
  for (const scene::Instance& instance : scene.instances)
    for (const uint32_t m : scene.meshes[instance.mesh].triangle_material)
      if (max_component(scene.materials[m].emission) > 0) found.insert(m);
  const std::string& first = scene.materials[*found.begin()].name;
  std::string out =
      first.empty() ? fmt::format("material {}", *found.begin()) : fmt::format("'{}'", first);
  if (found.size() > 1)
    out += fmt::format(", {} more material{}", found.size() - 1, found.size() > 2 ? "s" : "");
  return out;
}

}  // namespace

Result<std::string> about_faint_emission(const scene::Scene& scene) {
  // The bake builds its own later, of split sides: this one is gone by then.
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const SeenPlaces places = seen_places(scene, tracer);
  if (places.emission.size() < kLeastSeenPlaces) return std::string();
  Progress progress;
  LUXEL_TRY(const light::DirectLight direct,
            light::direct_light(scene, places.elements, light::collect_lights(scene), tracer,
                                {.samples = kRaysOfDay}, progress));
  size_t black = 0, open = 0;
  for (size_t i = 0; i < places.emission.size(); ++i) {
    if (max_component(direct.irradiance[i] / kPi + places.emission[i]) >= kFaintRadiance) continue;
    ++black, open += sees_the_open(tracer, places, i);
  }
  const double share = double(black) / double(places.emission.size());
  if (share < kMostlyBlack || double(open) < kOpenOfBlack * double(black)) return std::string();
  return fmt::format("what emits in the scene ({}) leaves {:.0f} % of what can be seen black",
                     names_of_emitters(scene), 100 * share);
}

}  // namespace luxel::pipeline
