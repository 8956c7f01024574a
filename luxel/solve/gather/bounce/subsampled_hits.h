// A copy of some of the hits, for sweeps over those alone.
#pragma once

#include <optional>
#include <vector>

#include "luxel/base/parallel.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {

/// A copy of every stride-th hit of each element: sweeps over some rays need not pass by the
/// others.
struct SubsampledHits {
  struct Tile {
    std::vector<uint32_t> end;  ///< per element: one past its last hit
    std::vector<StoredHit> hits;
    std::vector<float> weight;  ///< per hit: how many of its round it stands for
  };
  size_t stride = 1;
  std::vector<Tile> tiles;
};

/// Nothing where it might take more than `bytes`. Errors: the file of hits cannot be read,
/// cancelled.
Result<std::optional<SubsampledHits>> subsample(const TracedHits& hits, size_t stride,
                                                uint64_t bytes, Progress& progress);

/// Calls take(t, tile) for each tile, on several threads. Errors: cancelled.
template <class Take>
Status for_each_tile(const SubsampledHits& hits, Progress& progress, const Take& take) {
  parallel_for(hits.tiles.size(), 1, [&](size_t t, size_t) {
    if (!progress.cancelled()) take(t, hits.tiles[t]);
  });
  return stopped(progress);
}

}  // namespace luxel::gather
