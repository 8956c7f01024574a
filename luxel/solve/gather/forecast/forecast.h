// Forecasts gathering, from a trial of a few texels.
#pragma once

#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/gather.h"

namespace luxel::gather {

/// Time, rays and stored hits of gather() with the parameters' samples, without rounds.
struct Forecast {
  double direct_s = 0, supersample_s = 0, trace_s = 0, bounces_s = 0;
  double rays = 0;       ///< shadow rays and those of near paths included
  double hit_bytes = 0;  ///< of stored hits
  double seconds() const { return direct_s + supersample_s + trace_s + bounces_s; }
};

/// Fewer texels, which lie in some cells of the map, would say little about the others.
inline constexpr size_t kFewestTried = 4096;

/// The number of texels that are tried: about one in `part`, but `fewest` at least.
struct TrialSize {
  int part = 1;
  size_t fewest = kFewestTried;
};

/// Lights squares of 5 x 5 texels, spread over the map, and measures, by no more than kTrialRays
/// rays. Seconds are those of the machine as busy as it is. Errors: cancelled.
Result<Forecast> forecast(const light::TexelScene& in, const GatherParams& params,
                          const GatherStores& stores, TrialSize size, Progress& progress);
inline constexpr double kTrialRays = 2e7;

/// About `count` texels, those of some cells of the map: all texels are as likely, also those at
/// the borders of charts, where light is the dearest.
std::vector<uint32_t> texels_to_try(const atlas::TexelMap& map, size_t count);

}  // namespace luxel::gather
