// Forecasts the bounces, from a trial of some elements.
#pragma once

#include <cstdint>
#include <span>

#include "luxel/solve/gather/bounce/bounces.h"

namespace luxel::gather {

/// Time that one thread takes to look at one hit of the map [s], measured on the hits that there
/// are, all of them in memory.
double seconds_per_hit(const atlas::TexelMap& map, const TracedHits& hits);

/// Hits of the rays of some elements, and the elements' direct light.
struct TriedHits {
  const TracedHits& hits;
  std::span<const uint32_t> element;  ///< per element of `hits`, its number among all
  std::span<const Rgb> direct;        ///< per element of `hits`, as in bounce()
};

/// Estimates the sweeps over all rays that bounce() will need, sparse ones by their part, with so
/// many samples per element. An element that was not tried is taken to be as bright as the nearest
/// in the map that was. Elements without samples, or inside of solids, count as not tried. Errors:
/// the file of hits cannot be read.
Result<double> expected_sweeps(const atlas::TexelMap& map, const transport::Elements& elements,
                               const TriedHits& tried, int samples, const BounceParams& params);

}  // namespace luxel::gather
