// Every solver's answer, whatever it computed it on: how much light arrives at a surface point?
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/scene/scene.h"
#include "luxel/scene/sides.h"

namespace luxel::transport {

/// Irradiance E [W/m^2] stored per texel of a map, read back bilinearly inside each chart.
struct TexelField {
  const atlas::Atlas* atlas = nullptr;
  const atlas::TexelMap* map = nullptr;
  std::span<const Rgb> irradiance;  ///< one per texel of the map
};

/// E of the front side at a surface point: bilinear over those of the four nearest texels that
/// carry a sample, weights renormalised, so that nothing bleeds in from outside the chart.
Rgb irradiance_at(const TexelField& field, const scene::SurfacePoint& p);

/// rho E + tau E behind: what a surface point sends besides what it emits, pi times its radiance.
/// `irradiance_at(p)` is E of the side that p belongs to; what has but one is lit alike on both.
template <class IrradianceAt>
Rgb radiosity_at(const scene::Scene& scene, const scene::SurfacePoint& p,
                 const IrradianceAt& irradiance_at) {
  const Rgb reflected = scene::reflectance_at(scene, p) * irradiance_at(p);
  const Rgb tau = scene::diffuse_transmittance_at(scene, p);
  if (max_component(tau) <= 0) return reflected;
  return reflected + tau * irradiance_at(scene::other_side_of(scene, p).value_or(p));
}

}  // namespace luxel::transport
