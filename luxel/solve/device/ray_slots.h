// The rays that a round adds to elements, in the order in which a device takes them.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/device/rays_shared.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::device {

/// Slots of the elements [begin, end) that get rays. Those with as many rays lie together: a work
/// group has 64 slots, a tile, and takes as long as the one with the most.
struct SlotChunk {
  size_t begin = 0, end = 0;  ///< `begin` is a multiple of gather::kTileElements
  std::vector<on_device::RaySlot> slots;
  /// Per tile, where its hits begin, in rows of 64: the first of each slot, the second of each and
  /// so on. One extra entry: how many rows there are.
  std::vector<uint32_t> first_row{0};
};

struct RoundSlots {
  std::vector<SlotChunk> chunks;  ///< in the order of elements; none is without slots
  std::vector<uint32_t> shares;   ///< gather::CellShares in use: 8 words each, four bits for a cell
  uint64_t samples = 0;           ///< of all slots
};

/// Samples up to `target`, of elements that lack some. `places_of_chunk`: about so many in a
/// chunk, or those of gather::kTileElements elements.
RoundSlots slots_of_round(std::span<const uint16_t> target, const gather::TracedHits& hits,
                          uint64_t places_of_chunk);

}  // namespace luxel::device
