#include "luxel/reference/surfaces.h"

#include "luxel/base/parallel.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/elements.h"

namespace luxel::reference {
namespace {

/// Normals closer than this to the triangle's own are the same but for rounding.
constexpr float kFlat = 1e-5f;

bool is_curved(const scene::Scene& scene, uint32_t instance, uint32_t triangle, Vec3 front) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  if (mesh.normals.empty()) return false;
  for (const Barycentric corner : {Barycentric{0, 0}, {1, 0}, {0, 1}})
    if (length(scene::shading_normal(scene, {instance, triangle, corner}) - front) > kFlat)
      return true;
  return false;
}

}  // namespace

Surfaces surfaces_of(const scene::Scene& scene) {
  Surfaces out;
  out.first_triangle = scene::first_triangles(scene);
  out.front.resize(out.first_triangle.back());
  out.size_m.resize(out.first_triangle.back());
  out.curved.resize(out.first_triangle.back());
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const uint32_t first = out.first_triangle[i];
    parallel_for(out.first_triangle[i + 1] - first, 4096, [&](size_t begin, size_t end) {
      for (uint32_t t = uint32_t(begin); t < end; ++t) {
        const scene::Facet facet = scene::facet_of(scene, i, t);
        out.front[first + t] = facet.front;
        out.size_m[first + t] = facet.size_m;
        out.curved[first + t] = is_curved(scene, i, t, out.front[first + t]);
      }
    });
  }
  return out;
}

Receiver receiver_at(const scene::Scene& scene, const Surfaces& surfaces, const trace::Hit& hit) {
  const uint32_t number = surfaces.number(hit.instance, hit.triangle);
  const bool curved = surfaces.curved[number] != 0;
  if (curved && !hit.back_face) {
    const transport::SmoothPoint p = transport::smooth_point(scene, hit.point());
    return {p.start, p.normal, p.geometric_normal};
  }
  const Vec3 side = hit.back_face ? -surfaces.front[number] : surfaces.front[number];
  const Vec3 start =
      scene::off_surface(scene::world_position(scene, hit.point()), side, surfaces.size_m[number]);
  return {start, curved ? -scene::shading_normal(scene, hit.point()) : side, side};
}

}  // namespace luxel::reference
