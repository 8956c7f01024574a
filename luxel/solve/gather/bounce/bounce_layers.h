// The light of each layer after all bounces: the sweeps of bounces.h, for several layers at once.
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

struct LayersBounced {
  std::vector<std::vector<Rgb>> irradiance;  ///< E per layer, per element [W/m^2]
  /// Root mean square over the elements and channels of what the layers' sum missed of the whole
  /// and was shared out, over the mean irradiance.
  double shared_out = 0;
};

/// Light layer by layer before any bounce, and that of all layers after the bounces.
struct LayeredLight {
  std::vector<Rgb> source;     ///< layer by layer for each element: layer_sources()
  std::span<const Rgb> whole;  ///< E per element, of bounce() over the same hits
};

/// Bytes of each layer per element: direct light, LayeredLight::source, the solution and
/// LayersBounced::irradiance.
inline constexpr uint64_t kLayerBytesPerElement = 4 * sizeof(Rgb);
/// Bytes of a sweep's map of five layers per texel of the square, with coverage.
inline constexpr uint64_t kLayerMapBytesPerTexel = (5 * 3 + 1) * sizeof(float);

struct LayerBounceParams {
  int bounces = -1;                   ///< as in bounce()
  uint64_t spare_bytes = UINT64_MAX;  ///< memory that may be taken besides, as in bounce()
};

/// Solves  E_l = E_0,l + (1/N) sum over rays of B_l at the hit  for each layer l. E is linear in
/// E_0, so that the layers' solutions add up to that of the whole, which is known: `whole`, of
/// bounce() over the same hits with `bounces`. With all bounces (< 0) that saves most of the work.
/// Each layer begins with its share of the whole's light,
///
///   E_l <- E_l E / sum over layers of E_l      (per element and channel),
///
/// by what it has of E_0. Ten sweeps look at one ray in 16 (of fewer than 256: in 4, of fewer than
/// 64: at all); then light is shared out anew, so that of the noise of sparse sweeps only that of
/// the share is left. A sweep over every fourth ray and one over all follow, and what these leave
/// of rounding and of that noise is shared out in the same way: the layers add up to the whole.
/// With a given number of bounces N - 1 sweeps are over every fourth ray and the last over all.
/// `source` is E_0 layer by layer for each element: direct light and what rays brought without the
/// map. Sweeps over some of the rays look up the texel nearest to a hit, and not four. Errors:
/// cancelled, the file of hits cannot be read.
Result<LayersBounced> bounce_layers(const atlas::TexelMap& map, const transport::Elements& elements,
                                    const TracedHits& hits, std::span<const StoredHit> behind,
                                    LayeredLight light, const LayerBounceParams& params,
                                    Progress& progress);

/// E_0 of bounce_layers() from `direct`, that of lights, layer by layer for each element.
std::vector<Rgb> layer_sources(const TracedHits& hits, std::vector<Rgb> direct);

}  // namespace luxel::gather
