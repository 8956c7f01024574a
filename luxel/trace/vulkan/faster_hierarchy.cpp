#include "luxel/trace/vulkan/faster_hierarchy.h"

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/procedural.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::trace {
namespace {

/// 64 small spheres in disorder within a large one: rays from between them pass several.
scene::Scene scene_of_spheres() {
  scene::Scene scene = scene::inward_sphere(1, 3, {0.5f, 0.5f, 0.5f}, {});
  RandomStream random{1};
  for (int k = 0; k < 63; ++k) {
    const Vec3 place = uniform_sphere_sample(random.next2()) * (0.1f + 0.8f * random.next());
    scene.instances.push_back({"", 0, translation(place) * scaling({0.1f, 0.1f, 0.1f})});
  }
  return scene;
}

std::vector<Ray> rays_between_spheres(size_t count) {
  std::vector<Ray> rays(count);
  RandomStream random{2};
  for (Ray& ray : rays)
    ray = {uniform_sphere_sample(random.next2()) * (0.9f * random.next()), 0,
           uniform_sphere_sample(random.next2()), INFINITY};
  return rays;
}

}  // namespace

HierarchyKind own_hierarchy(const gpu::Device& device) {
  return device.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? HierarchyKind::wide : HierarchyKind::binary;
}

Result<std::vector<HierarchyRate>> measure_hierarchies(const gpu::Device& device, size_t count) {
  const scene::Scene scene = scene_of_spheres();
  const std::vector<Ray> rays = rays_between_spheres(count);
  std::vector<HierarchyKind> kinds{own_hierarchy(device)};
  if (device.has_ray_queries) kinds.push_back(HierarchyKind::driver);
  std::vector<HierarchyRate> out;
  for (const HierarchyKind kind : kinds) {
    LUXEL_TRY(DeviceRayTracer tracer, DeviceRayTracer::build(device, scene, kind));
    LUXEL_TRY(DeviceRays there, tracer.upload(rays));
    // The first times wake the device and find how many rays a piece has.
    double fastest_s = INFINITY;
    for (int time = 0; time < 4; ++time) {
      LUXEL_TRY(const double seconds, tracer.closest_hits(there));
      fastest_s = std::min(fastest_s, seconds);
    }
    out.push_back({kind, double(rays.size()) / fastest_s});
  }
  return out;
}

HierarchyKind faster_of(const std::vector<HierarchyRate>& measured) {
  // Both answer alike but for roundings: a choice that is close shall not change from day to day.
  constexpr double kClearly = 1.25;
  HierarchyRate best = measured.front();
  for (const HierarchyRate& one : measured)
    if (one.rays_per_s > kClearly * measured.front().rays_per_s) best = one;
  return best.kind;
}

HierarchyKind faster_hierarchy(const gpu::Device& device) {
  if (!device.has_ray_queries || device.type == VK_PHYSICAL_DEVICE_TYPE_CPU)
    return own_hierarchy(device);
  // As many as fill a large GPU.
  constexpr size_t kRays = size_t(1) << 18;
  const auto measured = measure_hierarchies(device, kRays);
  return measured ? faster_of(*measured) : own_hierarchy(device);
}

}  // namespace luxel::trace
