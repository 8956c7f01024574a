// What bouncing will take, from a trial of some elements.
#pragma once

#include <cstdint>
#include <span>

#include "luxel/solve/gather/bounce/bounces.h"

namespace luxel::gather {

/// What a look at one hit of the map takes one thread [s], measured on the hits that there are, all
/// of them in memory.
double seconds_per_hit(const atlas::TexelMap& map, const TracedHits& hits);

/// What the rays of some elements met, and their light.
struct TriedHits {
  const TracedHits& hits;
  std::span<const uint32_t> element;  ///< per element of `hits`, its number among all
  std::span<const Rgb> direct;        ///< per element of `hits`, as in bounce()
};

/// About how many sweeps over all rays bounce() will need, sparse ones by their part, with so many
/// samples per element. What lies where none was tried is taken to be as bright as the nearest in
/// the map that was; those without samples or inside of solids were
/// not. Errors: the file of hits cannot be read.
Result<double> expected_sweeps(const atlas::TexelMap& map, const transport::Elements& elements,
                               const TriedHits& tried, int samples, const BounceParams& params);

}  // namespace luxel::gather
