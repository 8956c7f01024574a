#include "luxel/solve/gather/bounce/subsampled_hits.h"

#include <algorithm>

#include "luxel/solve/gather/rays/tile_hits.h"

namespace luxel::gather {
namespace {

uint64_t stored_hits(const TracedHits& hits) {
  return (hits.bytes_in_memory() + hits.bytes_in_file()) / sizeof(StoredHit);
}

}  // namespace

Result<std::optional<SubsampledHits>> subsample(const TracedHits& hits, size_t stride,
                                                uint64_t bytes, Progress& progress) {
  // At most one hit more than the part, per element and round.
  const uint64_t most = stored_hits(hits) / stride + hits.size() * hits.rounds.size();
  const uint64_t bytes_of_ends = hits.size() * sizeof(uint32_t);
  if (most * (sizeof(StoredHit) + sizeof(float)) + bytes_of_ends > bytes) return std::nullopt;
  SubsampledHits out;
  out.stride = stride;
  out.tiles.resize(tile_count(hits));
  LUXEL_TRY_STATUS(for_each_tile(hits, progress, [&](size_t t, const TileHits& tile) {
    const size_t begin = t * kTileElements, end = std::min(begin + kTileElements, hits.size());
    size_t count = 0;
    for (const HitTile* round : tile.round) count += round->entries.size() / stride + (end - begin);
    SubsampledHits::Tile& subsampled = out.tiles[t];
    subsampled.hits.reserve(count), subsampled.weight.reserve(count),
        subsampled.end.reserve(end - begin);
    for (size_t i = begin; i < end; ++i) {
      for_each_sparse(hits, tile, i, stride, [&](StoredHit hit, float weight) {
        subsampled.hits.push_back(hit), subsampled.weight.push_back(weight);
      });
      subsampled.end.push_back(uint32_t(subsampled.hits.size()));
    }
  }));
  return out;
}

}  // namespace luxel::gather
