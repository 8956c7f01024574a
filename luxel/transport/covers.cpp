#include "luxel/transport/covers.h"

#include <algorithm>
#include <array>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/surface_points.h"

namespace luxel::transport {
namespace {

/// A cover is no higher than this part of the size.
constexpr float kHighest = 0.25f;
/// Rays leave the gap at so many times its height: covers need not be quite even.
constexpr float kAbove = 1.5f;
/// Rays back down begin at this part of the height: off what the first rays met.
constexpr float kOffTheCover = 1e-2f;
/// Rays less steep than this stay in the gap, whatever its width: 1 / 16^2 = 0.4 % of them.
constexpr float kSteep = 1.0f / 16;
/// Covered places see less than this of what lies beyond.
constexpr float kOpen = 0.1f;
constexpr uint32_t kRays = 64;
/// Where so much of the emitting surface is covered, the scene's light is made in gaps: a panel
/// close to a ceiling has half of its two sides in one.
constexpr double kMadeInGaps = 0.75;
constexpr size_t kShiningPlaces = 256;

/// Places of the fronts that emit, spread over their area; none where nothing emits.
std::vector<scene::SurfacePoint> shining_places(const scene::Scene& scene) {
  const auto emits = [](const scene::Scene& s, const scene::SurfacePoint& p) {
    const scene::Mesh& mesh = s.meshes[s.instances[p.instance].mesh];
    return max_component(s.materials[mesh.triangle_material[p.triangle]].emission) > 0;
  };
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      if (emits(scene, {i, t, {}}))
        return scene::points_uniform_in_area(scene, kShiningPlaces, 1, emits);
  return {};
}

}  // namespace

float open_share(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, float size_m) {
  const trace::Hit above = tracer.closest_hit({from, 0, normal, kHighest * size_m});
  if (!above.found()) return 1;
  // Hits of rays on their way out of the gap.
  std::array<trace::Ray, kRays> rays;
  std::array<trace::Hit, kRays> hits;
  const Frame frame = frame_around(normal);
  for (uint32_t k = 0; k < kRays; ++k) {
    const Vec3 d = cosine_hemisphere_sample(sobol_owen_2d(k, 5));
    rays[k] = {from, 0, frame.to_world(d), kAbove * above.t / std::max(d.z, kSteep)};
  }
  tracer.closest_hits(rays, hits);
  // A ray down from each hit tells if it lies over the place's own surface.
  std::array<trace::Ray, kRays> down;
  std::array<uint8_t, kRays> closed{};
  size_t met = 0;
  for (uint32_t k = 0; k < kRays; ++k) {
    if (!hits[k].found()) continue;
    const Vec3 way = rays[k].direction * hits[k].t;
    const float height = dot(way, normal);
    down[met++] = {from + way, kOffTheCover * height, -normal, kAbove * height};
  }
  tracer.occluded(std::span(down).first(met), std::span(closed).first(met));
  const float open = 1 - float(std::count(closed.begin(), closed.end(), 1)) / float(kRays);
  return open < kOpen ? open : 1;
}

float size_for_covers(const scene::Scene& scene, const trace::RayTracer& tracer, float size_m) {
  const std::vector<scene::SurfacePoint> places = shining_places(scene);
  const auto is_covered = [&](const scene::SurfacePoint& p) {
    const Vec3 normal = scene::front_normal(scene, p.instance, p.triangle);
    return open_share(tracer, scene::off_surface(scene, p, normal), normal, size_m) < 1;
  };
  const auto covered = double(std::ranges::count_if(places, is_covered));
  const bool made_in_gaps = !places.empty() && covered >= kMadeInGaps * double(places.size());
  return made_in_gaps ? 0.0f : size_m;
}

std::vector<float> open_shares(const trace::RayTracer& tracer, const Elements& elements,
                               float size_m) {
  std::vector<float> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out[i] = open_share(tracer, elements.position[i], elements.geometric_normal[i], size_m);
  });
  return out;
}

}  // namespace luxel::transport
