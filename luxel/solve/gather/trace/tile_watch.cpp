#include "luxel/solve/gather/trace/tile_watch.h"

#include <algorithm>
#include <numeric>

#include "luxel/base/check.h"

namespace luxel::gather {

TileQueue::TileQueue(size_t tiles) : left_(tiles) { std::iota(left_.rbegin(), left_.rend(), 0); }

size_t TileQueue::next() {
  const std::lock_guard lock(mutex_);
  LUXEL_CHECK(!left_.empty());
  const size_t tile = left_.back();
  left_.pop_back();
  return tile;
}

void TileQueue::prefer(const std::function<float(size_t tile)>& share) {
  // Tracing goes on while shares are worked out.
  std::vector<uint32_t> tiles;
  {
    const std::lock_guard lock(mutex_);
    tiles = left_;
  }
  std::vector<float> shares(tiles.empty() ? 0 : *std::ranges::max_element(tiles) + 1);
  for (const uint32_t tile : tiles) shares[tile] = share(tile);
  const std::lock_guard lock(mutex_);
  std::ranges::sort(left_, [&](uint32_t a, uint32_t b) {
    return shares[a] != shares[b] ? shares[a] < shares[b] : a > b;
  });
}

}  // namespace luxel::gather
