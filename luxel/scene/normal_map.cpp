#include "luxel/scene/normal_map.h"

#include <cmath>
#include <optional>

namespace luxel::scene {
namespace {

/// Unit vectors along growing u and falling v, at right angles to the normal.
struct TangentFrame {
  Vec3 u, minus_v;
};

/// None where texture coordinates have no area.
std::optional<TangentFrame> tangent_frame(const Scene& scene, const SurfacePoint& p,
                                          const TextureRef& ref, Vec3 normal) {
  const Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  const std::vector<Vec2>& uv = ref.uv_set == 1 ? mesh.uv1 : mesh.uv0;
  if (uv.empty()) return std::nullopt;
  const auto& corner = mesh.triangles[p.triangle];
  const Vec2 a = transformed_uv(ref, uv[corner[0]]);
  const Vec2 ab = transformed_uv(ref, uv[corner[1]]) - a,
             ac = transformed_uv(ref, uv[corner[2]]) - a;
  const float area = cross(ab, ac);
  if (area == 0 || !std::isfinite(area)) return std::nullopt;
  // P(u, v) is linear over the triangle: its derivatives by Cramer's rule, but for their lengths.
  const Triangle3 t = world_triangle(scene, p.instance, p.triangle);
  const float side = area > 0 ? 1.0f : -1.0f;
  const Vec3 by_u = ((t.b - t.a) * ac.y - (t.c - t.a) * ab.y) * side;
  const Vec3 by_v = ((t.c - t.a) * ab.x - (t.b - t.a) * ac.x) * side;
  const Vec3 flat = by_u - normal * dot(normal, by_u);
  if (!(length(flat) > 0)) return std::nullopt;
  const Vec3 u = normalize(flat), across = cross(normal, u);
  return TangentFrame{u, dot(across, by_v) > 0 ? -across : across};
}

}  // namespace

Vec3 bent_normal(const Scene& scene, const SurfacePoint& p) {
  const Vec3 normal = shading_normal(scene, p);
  const Material& material = material_at(scene, p);
  const TextureRef& ref = material.normal_texture;
  if (ref.texture == kNone) return normal;
  const auto frame = tangent_frame(scene, p, ref, normal);
  if (!frame) return normal;
  const auto c = texture_at(scene, p, ref, false);
  const Vec3 bent = frame->u * ((2 * c[0] - 1) * material.normal_scale) +
                    frame->minus_v * ((2 * c[1] - 1) * material.normal_scale) +
                    normal * (2 * c[2] - 1);
  return length(bent) > 0 ? normalize(bent) : normal;
}

}  // namespace luxel::scene
