// Every solver's answer, whatever it computed it on: how much light arrives at a surface point?
#pragma once

#include <span>
#include <vector>

#include "atlas/atlas.h"
#include "scene/scene.h"

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

}  // namespace luxel::transport
