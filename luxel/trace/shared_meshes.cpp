#include "luxel/trace/shared_meshes.h"

#include <cmath>

namespace luxel::trace {

std::vector<bool> shared_meshes(const scene::Scene& scene, size_t max_flat_triangles) {
  std::vector<uint32_t> uses(scene.meshes.size());
  for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh];
  const bool large = scene::first_triangles(scene).back() > max_flat_triangles;
  std::vector<bool> shared;
  for (const uint32_t n : uses) shared.push_back(large && n > 1);
  return shared;
}

bool can_be_undone(const Mat34& m) {
  const float size = length(column(m, 0)) * length(column(m, 1)) * length(column(m, 2));
  return std::abs(determinant(m)) > 1e-6f * size;
}

}  // namespace luxel::trace
