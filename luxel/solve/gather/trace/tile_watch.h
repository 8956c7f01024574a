// Tracing that somebody watches: which tiles come first, and who gets what they bring.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

#include "luxel/solve/gather/rays/hit_store.h"

namespace luxel::gather {

/// Hands out tiles, each once, those first that a function prefers. Thread-safe.
class TileQueue {
 public:
  explicit TileQueue(size_t tiles);

  /// The number of the next tile. As many calls as there are tiles.
  size_t next();
  /// Puts what is left into another order: tiles of a larger share first, by number where they are
  /// equal.
  void prefer(const std::function<float(size_t tile)>& share);

 private:
  std::mutex mutex_;
  std::vector<uint32_t> left_;  ///< the next one is the last
};

/// Watches a round. Its calls change no bit of the round's result.
struct TileWatch {
  TileQueue* queue = nullptr;
  /// Gets the hits of a tile's elements, from number `first` on, by the thread that has traced
  /// them.
  std::function<void(size_t first, const HitTile& hits)> on_tile{};
};

}  // namespace luxel::gather
