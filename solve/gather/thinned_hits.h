// A copy of some of the hits, for sweeps over those alone.
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "solve/gather/trace_hits.h"

namespace luxel::gather {

/// A copy of every stride-th hit of each element: sweeps over some rays need not pass by the
/// others.
struct ThinnedHits {
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
Result<std::optional<ThinnedHits>> thin(const TracedHits& hits, size_t stride, uint64_t bytes,
                                        Progress& progress);

}  // namespace luxel::gather
