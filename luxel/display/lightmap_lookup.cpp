#include "luxel/display/lightmap_lookup.h"

#include "luxel/display/bilinear.h"

namespace luxel::display {

Rgb lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                const scene::SurfacePoint& p) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  if (mesh.uv1.empty()) return {};
  const auto& t = mesh.triangles[p.triangle];
  const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at);
  return bilinear_at(lightmap, uv);
}

}  // namespace luxel::display
