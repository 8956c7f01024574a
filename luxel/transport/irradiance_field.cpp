#include "luxel/transport/irradiance_field.h"

namespace luxel::transport {

Rgb irradiance_at(const TexelField& field, const scene::SurfacePoint& p) {
  const auto& corners = field.atlas->corners[field.atlas->triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const int side = field.map->resolution;
  const int x0 = int(std::floor(at.x - 0.5f)), y0 = int(std::floor(at.y - 0.5f));
  const float fx = at.x - 0.5f - float(x0), fy = at.y - 0.5f - float(y0);
  Rgb sum{};
  float weight = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int x = x0 + i, y = y0 + j;
      if (x < 0 || y < 0 || x >= side || y >= side) continue;
      const uint32_t texel = field.map->texel_at[size_t(y) * size_t(side) + size_t(x)];
      if (texel == atlas::kNone) continue;
      const float w = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      sum += field.irradiance[texel] * w;
      weight += w;
    }
  return weight > 0 ? sum / weight : Rgb{};
}

}  // namespace luxel::transport
