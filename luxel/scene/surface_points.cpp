#include "luxel/scene/surface_points.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"

namespace luxel::scene {

Chosen of_material(uint32_t material) {
  return [material](const Scene& scene, const SurfacePoint& p) {
    return scene.meshes[scene.instances[p.instance].mesh].triangle_material[p.triangle] == material;
  };
}

std::vector<SurfacePoint> points_uniform_in_area(const Scene& scene, size_t count, uint64_t seed,
                                                 const Chosen& chosen) {
  std::vector<SurfacePoint> triangles;
  std::vector<double> area_below{0};
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      if (!chosen(scene, {i, t, {}})) continue;
      triangles.push_back({i, t, {}});
      area_below.push_back(area_below.back() + double(area_m2(world_triangle(scene, i, t))));
    }
  LUXEL_CHECK(!triangles.empty());
  RandomStream random{hash64(seed)};
  std::vector<SurfacePoint> points;
  for (size_t k = 0; k < count; ++k) {
    const double area = (double(k) + double(random.next())) / double(count) * area_below.back();
    const auto found = std::upper_bound(area_below.begin() + 1, area_below.end() - 1, area);
    SurfacePoint p = triangles[size_t(found - area_below.begin()) - 1];
    p.at = triangle_sample(sobol_owen_2d(uint32_t(k), hash64(seed)));
    points.push_back(p);
  }
  return points;
}

}  // namespace luxel::scene
