#include "luxel/display/lightmap_lookup.h"

#include "luxel/display/bilinear.h"

namespace luxel::display {

Rgb lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                const scene::SurfacePoint& p) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  if (mesh.uv1.empty()) return {};
  const auto& t = mesh.triangles[p.triangle];
  const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at);
  const BilinearTexels texels = bilinear_texels(lightmap.width, lightmap.height, uv);
  Rgb sum{};
  for (size_t k = 0; k < 4; ++k)
    sum += lightmap.rgb(texels.texel[k][0], texels.texel[k][1]) * texels.weight[k];
  return sum;
}

}  // namespace luxel::display
