#include "luxel/pipeline/bake/dark_surfaces.h"

#include <algorithm>

#include "luxel/pipeline/settings/outside_light.h"

namespace luxel::pipeline {
namespace {

/// Solid things stand on floors and walls: some part of every scene is hidden from its light.
constexpr double kWorthSaying = 0.2;
/// Light below this part of the mean is none: what stitching and refilling spread is more.
constexpr double kNoLight = 1e-6;

/// All light of a scene comes from its surroundings and from suns.
bool is_lit_from_outside(const scene::Scene& scene) {
  const bool lamps = std::ranges::any_of(scene.lights, [](const scene::PunctualLight& light) {
    return light.kind != scene::PunctualLight::Kind::directional &&
           max_component(light.intensity) > 0;
  });
  const bool glows = std::ranges::any_of(
      scene.materials, [](const scene::Material& m) { return max_component(m.emission) > 0; });
  return !lamps && !glows;
}

/// The share of the texels outside of solids that have no light.
double dark_share(const Bake& bake) {
  const std::vector<uint8_t>& hidden = bake.light.hidden;
  std::vector<double> seen;
  double sum = 0;
  for (size_t i = 0; i < bake.light.irradiance.size(); ++i) {
    if (!hidden.empty() && hidden[i]) continue;
    seen.push_back(double(luminance(bake.light.irradiance[i])));
    sum += seen.back();
  }
  if (seen.empty()) return 0;
  const double none = kNoLight * sum / double(seen.size());
  return double(std::ranges::count_if(seen, [&](double e) { return !(e > none); })) /
         double(seen.size());
}

}  // namespace

std::string about_dark_surfaces(const Bake& bake) {
  const double share = dark_share(bake);
  if (share >= 1) return no_light_arrives("every surface");
  if (share < kWorthSaying || !is_lit_from_outside(bake.scene)) return {};
  return no_light_arrives(fmt::format("{:.0f} % of the surfaces", 100 * share));
}

}  // namespace luxel::pipeline
