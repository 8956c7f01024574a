// Light straight from lamps, told apart from other light: it can be drawn pixel by pixel.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/lights.h"
#include "luxel/view/live/known_light.h"

namespace luxel::view {

/// The lights of a scene without its point, spot and directional ones.
light::Lights without_lamps(const light::Lights& lights);

/// True: there is no light whose origin direct_light() knows.
bool is_dark(const light::Lights& lights);

/// Sampling of direct light in a bake.
struct LampLightParams {
  int direct_samples = 64;  ///< towards discs of suns
  int supersample = 1;      ///< points per texel
  uint64_t seed = 1;
};

/// Fills KnownLight::of_lamps, as the bake would have it if there were nothing but lamps. Lamps
/// with a light profile are not told apart, nor are the others of their scene. Errors: cancelled.
Status tell_lamps_apart(const LampLightParams& params, KnownLight& known, Progress& progress);

/// E of what is known, but for what comes straight from lamps; empty: it is not told apart.
std::vector<Rgb> light_without_lamps(const KnownLight& known);

}  // namespace luxel::view
