// Forecasts rounds to an error, from the rounds of some texels.
#pragma once

#include "luxel/solve/gather/forecast/forecast.h"

namespace luxel::gather {

/// Time, rays and stored hits of gather() with the parameters' max_error, after its first round.
struct RoundsForecast {
  double trace_s = 0;    ///< rays, and shadow rays
  double bounces_s = 0;  ///< of each round, and the last ones
  double rays = 0;       ///< shadow rays and those of near paths included
  double hit_bytes = 0;  ///< of stored hits
};

/// Lights the map with few rays, and makes all rounds in that light for the texels of some cells,
/// about one texel in `part`, but some thousand at least. Errors: cancelled, disk full.
Result<RoundsForecast> forecast_rounds(const light::TexelScene& in, const GatherParams& params,
                                       const GatherStores& stores, int part, Progress& progress);

}  // namespace luxel::gather
