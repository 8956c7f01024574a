// Tiles of traced hits as parts that are kept (luxel/base/part_store.h).
#pragma once

#include <optional>
#include <span>

#include "luxel/base/bytes.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {

/// The round of tracing that takes `hits` on to `target`.
KeptStage kept_round(const TracedHits& hits, std::span<const uint16_t> target,
                     const TraceParams& params);

/// A tile of a round with the rays that it took.
struct TracedTile {
  RayTile rays_met;  ///< ends only where it was traced
  uint64_t rays = 0;
  uint64_t kept = 0;  ///< of an earlier bake, besides
};

/// Keeps tile number `part` and what `hits` counts for its elements. Returns where its entries
/// stand then, if anywhere.
KeptEntries keep_tile(const KeptStage& kept, size_t part, const TracedTile& tile,
                      const TracedHits& hits);

struct FoundTile {
  TracedTile tile;
  KeptEntries entries;
};
/// A tile that was kept, and into `hits` what it counted; nothing where it cannot be of a round
/// that takes `hits` on to `target`. `places`: StoredHit::base() is below.
std::optional<FoundTile> find_tile(const KeptStage& kept, size_t begin, size_t end, uint32_t places,
                                   std::span<const uint16_t> target, TracedHits& hits);

/// Writes the counts of `hits` for the elements of a tile.
void put_counts(const TracedHits& hits, size_t tile, ByteWriter& out);
/// Reads them into `hits`. False: there was not enough.
bool get_counts(ByteReader& in, size_t tile, TracedHits& hits);

}  // namespace luxel::gather
