#include "transport/elements.h"

#include "base/parallel.h"

namespace luxel::transport {
namespace {

/// Barycentric coordinates of a point of the atlas in a triangle of it.
Barycentric barycentric_in(const std::array<Vec2, 3>& t, Vec2 p) {
  const Vec2 e1 = t[1] - t[0], e2 = t[2] - t[0], d = p - t[0];
  const float area = cross(e1, e2);
  if (area == 0) return {-1, -1};
  return {cross(d, e2) / area, cross(e1, d) / area};
}

bool varies_over_texels(const scene::Material& material) {
  return material.base_color_texture.texture != scene::kNone ||
         material.metallic_texture.texture != scene::kNone;
}

/// Mean reflectance over a 4 x 4 grid of the texel, where the triangle covers it.
Rgb mean_reflectance(const scene::Scene& scene, const atlas::Atlas& atlas,
                     const atlas::Texel& texel) {
  constexpr int kGrid = 4;
  const auto& corners = atlas.corners[texel.triangle_number];
  Rgb sum = scene::reflectance_at(scene, texel.sample);
  float count = 1;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      const Vec2 p{float(texel.x) + (float(i) + 0.5f) / kGrid,
                   float(texel.y) + (float(j) + 0.5f) / kGrid};
      const Barycentric at = barycentric_in(corners, p);
      if (at.u < 0 || at.v < 0 || at.u + at.v > 1) continue;
      sum += scene::reflectance_at(scene, {texel.sample.instance, texel.sample.triangle, at});
      count += 1;
    }
  return sum / count;
}

}  // namespace

Elements elements_from_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const atlas::TexelMap& map) {
  Elements e;
  const size_t n = map.texels.size();
  e.position.resize(n), e.normal.resize(n), e.geometric_normal.resize(n), e.reflectance.resize(n);
  parallel_for(n, 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const atlas::Texel& texel = map.texels[i];
      const scene::SurfacePoint& p = texel.sample;
      e.position[i] = scene::world_position(scene, p);
      e.normal[i] = scene::shading_normal(scene, p);
      e.geometric_normal[i] = scene::front_normal(scene, p.instance, p.triangle);
      e.reflectance[i] = varies_over_texels(scene::material_at(scene, p))
                             ? mean_reflectance(scene, atlas, texel)
                             : scene::reflectance_at(scene, p);
    }
  });
  return e;
}

}  // namespace luxel::transport
