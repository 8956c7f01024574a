#include "luxel/display/lightmap_lookup.h"

#include <algorithm>
#include <cmath>

namespace luxel::display {

Rgb lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                const scene::SurfacePoint& p) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  if (mesh.uv1.empty()) return {};
  const auto& t = mesh.triangles[p.triangle];
  const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at);
  const float x = uv.x * float(lightmap.width) - 0.5f, y = uv.y * float(lightmap.height) - 0.5f;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  const float fx = x - float(x0), fy = y - float(y0);
  Rgb sum{};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i)
      sum += lightmap.rgb(std::clamp(x0 + i, 0, lightmap.width - 1),
                          std::clamp(y0 + j, 0, lightmap.height - 1)) *
             ((i ? fx : 1 - fx) * (j ? fy : 1 - fy));
  return sum;
}

}  // namespace luxel::display
