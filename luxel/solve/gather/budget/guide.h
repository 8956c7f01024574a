// The making of a guide: a few rays of every neighbourhood tell where others are worth most.
//
// Neighbours of one chart see nearly the same: they share what is known of how much rays of each
// cell differ (cell_guide.h). [Silvennoinen19] guides rays of lightmaps by densities that are
// learned per texel, and weighs each ray; here shares are powers of two, and each cell's mean is
// what it is whatever the shares are.
#pragma once

#include <span>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {

/// Light that rays see.
struct LightToGuide {
  const TracedHits& hits;
  std::span<const StoredHit> behind;
  std::span<const Rgb> irradiance;  ///< E per element, after all bounces [W/m^2]
  Team* team = nullptr;             ///< whose members share groups out; null: none
  /// Per element, above 0: it asks for a guide; the others have none. Empty: all ask.
  std::span<const float> asks = {};
};

/// Shares of directions for groups of elements: at most 8 x 8 texels of one chart. Rays that tell
/// them are no part of the light, which so is unbiased. Errors: cancelled, another member gives up.
Result<Guide> make_guide(const light::TexelScene& in, const transport::OwnSides& sides,
                         const LightToGuide& light, uint64_t seed, Progress& progress);

}  // namespace luxel::gather
