// Planes through the light around texels, each round from a larger window.
#pragma once

#include <optional>
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

/// Light that a texel shows to its neighbours, side by side in memory.
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
  /// Per texel. Members of a team know slopes of their own texels alone, which nobody else asks
  /// for.
  std::vector<Plane> planes;
  std::vector<Shown> shown;  ///< each as the others see it: a buffer
  /// The squares of the atlas (texel_tile.h) whose texels are this member's, or all; none before
  /// the first round.
  std::optional<std::vector<uint32_t>> own_squares{};
};

/// Units of Progress per texel that has noise; as kNeighbourhoodUnits.
inline uint64_t grow_units(float radius) {
  const uint64_t across = 2 * uint64_t(radius) + 1;
  return across * ((across + 7) / 8) + 4;
}

/// One round: every texel's plane from the texels around it, weighted by how well the estimates of
/// the round before agree. What is shown is made anew from the planes, which are then replaced.
/// Members of a team share the texels out; null: there is none. Errors: cancelled, another member
/// gives up.
Status grow(const Neighbourhood& n, const NoiseLevel& noise, std::span<const Rgb> values,
            const GrowRound& round, Planes& now, Team* team, Progress& progress);

}  // namespace luxel::post
