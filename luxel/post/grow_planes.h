// Planes through the light around texels, each round from a larger window.
#pragma once

#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/post/neighbours.h"
#include "luxel/post/noise_level.h"

namespace luxel::post {

/// A plane through the light around a texel: E(u, v) = value + u slope_u + v slope_v, u and v in
/// texels.
struct Plane {
  Rgb value, slope_u, slope_v;
  float variance = 0;        ///< of the value's luminance
  float slope_variance = 0;  ///< mean of both slopes'
};

/// What a texel shows to its neighbours, side by side in memory.
struct Shown {
  Rgb estimate;
  float estimate_variance = 0;
  Rgb value;  ///< its own, unfiltered
  float variance = 0;
};

struct GrowRound {
  float radius = 0;           ///< of the windows, in texels
  float max_deviations2 = 0;  ///< largest squared difference over its variance that counts
};
struct Planes {
  std::vector<Plane> planes;  ///< per texel
  std::vector<Shown> shown;   ///< what the others see of each: a buffer
};

/// One round: every texel's plane from the texels around it, weighted by how well the estimates of
/// the round before agree. What is shown is made anew from the planes, which are then replaced.
/// Errors: cancelled.
Status grow(const Neighbourhood& n, const NoiseLevel& noise, std::span<const Rgb> values,
            const GrowRound& round, Planes& now, Progress& progress);

}  // namespace luxel::post
