// The stored hits of neighbouring elements, as sweeps read them.
#pragma once

#include <mutex>
#include <span>
#include <vector>

#include "luxel/base/parallel.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {

/// The hits of a tile's elements in all rounds.
struct TileHits {
  std::vector<HitTile> buffer;
  std::vector<const HitTile*> round;

  Status read(const TracedHits& hits, size_t tile) {
    buffer.resize(hits.rounds.size()), round.resize(hits.rounds.size());
    for (size_t r = 0; r < round.size(); ++r) {
      LUXEL_TRY(round[r], hits.rounds[r].get(tile, buffer[r]));
    }
    return {};
  }
  /// Hits of the tile's k-th element in round r.
  std::span<const StoredHit> of(size_t r, size_t k) const {
    const HitTile& tile = *round[r];
    const uint32_t first = k == 0 ? 0 : tile.end[k - 1];
    return std::span(tile.entries).subspan(first, tile.end[k] - first);
  }
};

/// Hits lie anywhere in the map, which no cache near a core holds: what will be looked up so many
/// hits later is asked for in time.
inline constexpr size_t kAhead = 16;

inline size_t tile_count(const TracedHits& hits) {
  return (hits.size() + kTileElements - 1) / kTileElements;
}

/// Calls take(t, tile) for each tile that is here, on several threads. Errors: the file of hits
/// cannot be read, cancelled.
template <class Take>
Status for_each_tile(const TracedHits& hits, Progress& progress, const Take& take) {
  std::mutex mutex;
  Status status;
  parallel_for(tile_count(hits), 1, [&](size_t t, size_t) {
    if (progress.cancelled() || !has_tile(hits, t)) return;
    TileHits tile;
    if (const Status read = tile.read(hits, t); !read) {
      const std::lock_guard lock(mutex);
      status = read;
      return;
    }
    take(t, tile);
  });
  if (!status) return status;
  return stopped(progress);
}

/// Where a sweep begins that looks at every stride-th of an element's `count` hits. Neighbours look
/// at different rays, so that what a sparse sweep misses averages out.
inline size_t first_hit(size_t element, size_t stride, size_t count) {
  return count == 0 ? 0 : std::min((element * 5) % stride, count - 1);
}

/// Calls take(hit, weight) for every stride-th hit of an element, counted for all of its round.
template <class Take>
void for_each_sparse(const TracedHits& hits, const TileHits& tile, size_t element, size_t stride,
                     const Take& take) {
  for (size_t r = hits.first_round[element]; r <= hits.last_round[element]; ++r) {
    const std::span<const StoredHit> own = tile.of(r, element % kTileElements);
    const size_t first = first_hit(element, stride, own.size());
    if (own.empty()) continue;
    const float weight = float(own.size()) / float((own.size() - first - 1) / stride + 1);
    for (size_t k = first; k < own.size(); k += stride) take(own[k], weight);
  }
}

}  // namespace luxel::gather
