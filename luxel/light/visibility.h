// Shares of lights and of the open surroundings that texels see. No radiometry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/texel_scene.h"

namespace luxel::light {

struct VisibilityParams {
  int points = 16;   ///< of each texel's footprint
  int samples = 16;  ///< shadow rays from each of them towards the disc of a directional light
  uint64_t seed = 1;
};

/// The share in [0, 1] of a point, spot or directional light that each texel sees, the mean over
/// its points: 0 where it turns away, the luminance of the tint behind coloured glass. Cones,
/// ranges and profiles do not count, since whoever reads the share works out the light itself. A
/// directional light's disc counts by the cosine to its parts. Hidden texels have 0. Errors:
/// cancelled.
Result<std::vector<float>> visible_share(const TexelScene& in, std::span<const uint8_t> hidden,
                                         const scene::PunctualLight& light,
                                         const VisibilityParams& params, Progress& progress);

struct OcclusionParams {
  float distance_m = INFINITY;  ///< what is farther away does not count
  int rays = 256;               ///< per texel
  int points = 16;              ///< of its footprint, from which they start in turn
  uint64_t seed = 1;
};

/// The share of cosine-weighted directions in which nothing lies within distance_m: 1 - the form
/// factor of what does. Hidden texels have 0. Errors: cancelled. [Zhukov98]
Result<std::vector<float>> open_share(const TexelScene& in, std::span<const uint8_t> hidden,
                                      const OcclusionParams& params, Progress& progress);

}  // namespace luxel::light
