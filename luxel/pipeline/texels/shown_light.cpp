#include "luxel/pipeline/texels/shown_light.h"

#include "luxel/base/parallel.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

constexpr float kLeast = 0.01f;

/// The reflectance that a viewer assumes.
Rgb shown_reflectance(const scene::Scene& scene, const scene::SurfacePoint& p) {
  const scene::Material& material = scene::material_at(scene, p);
  const auto c = scene::base_color_at(scene, p);
  return max(Rgb{c[0], c[1], c[2]} * (1 - material.metallic), Rgb{kLeast, kLeast, kLeast});
}

}  // namespace

std::vector<Rgb> shown_irradiance(const scene::Scene& scene, const atlas::Atlas& atlas,
                                  const atlas::TexelMap& map, std::span<const Rgb> irradiance) {
  std::vector<Rgb> shown(irradiance.begin(), irradiance.end());
  const transport::TexelField field{&atlas, &map, irradiance};
  parallel_for(shown.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& p = map.texels[i].sample;
      if (max_component(scene::diffuse_transmittance_at(scene, p)) <= 0) continue;
      const auto own = [&](const scene::SurfacePoint& q) {
        return q.instance == p.instance && q.triangle == p.triangle
                   ? irradiance[i]
                   : transport::irradiance_at(field, q);
      };
      const Rgb base = shown_reflectance(scene, p), sent = transport::radiosity_at(scene, p, own);
      shown[i] = {sent.x / base.x, sent.y / base.y, sent.z / base.z};
    }
  });
  return shown;
}

}  // namespace luxel::pipeline
