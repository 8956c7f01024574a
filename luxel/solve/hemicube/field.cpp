#include "luxel/solve/hemicube/field.h"

#include "luxel/base/check.h"

namespace luxel::hemicube {

Rgb irradiance_at(const Field& field, const scene::SurfacePoint& p) {
  const MeshPoint point = locate(field.mesh, p);
  if (field.receivers.kind == ElementKind::triangle)
    return field.irradiance[field.receivers.leaf_of_node[point.node]];
  const auto& v = field.mesh.nodes[point.node].vertex;
  return interpolate(field.irradiance[v[0]], field.irradiance[v[1]], field.irradiance[v[2]],
                     point.at);
}

Field smoothed(const scene::Scene& scene, const Field& per_triangle,
               std::span<const uint8_t> enclosed, std::span<const uint8_t> covered) {
  LUXEL_CHECK(per_triangle.receivers.kind == ElementKind::triangle);
  Field out;
  out.mesh = per_triangle.mesh;
  out.receivers = make_receivers(scene, out.mesh, ElementKind::vertex);
  out.irradiance.resize(out.receivers.size());
  std::vector<float> weight(out.receivers.size());
  for (size_t i = 0; i < per_triangle.receivers.leaves.size(); ++i) {
    if (enclosed[i] || covered[i]) continue;
    const float area = per_triangle.receivers.area_m2[i];
    for (const uint32_t v : out.mesh.nodes[per_triangle.receivers.leaves[i]].vertex) {
      out.irradiance[v] += per_triangle.irradiance[i] * area;
      weight[v] += area;
    }
  }
  for (size_t v = 0; v < weight.size(); ++v)
    if (weight[v] > 0) out.irradiance[v] = out.irradiance[v] / weight[v];
  return out;
}

}  // namespace luxel::hemicube
