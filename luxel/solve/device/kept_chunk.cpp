#include "luxel/solve/device/kept_chunk.h"

#include <optional>

#include "luxel/solve/device/device_elements.h"

namespace luxel::device {
namespace {

/// Its hits as the device has them.
struct ChunkHits {
  const SlotChunk& slots;
  std::vector<gather::StoredHit> rows;

  /// Adds those of the k-th slot.
  void add(uint32_t k, std::vector<gather::StoredHit>& out) const {
    for (uint32_t place = 0; place < slots.slots[k].places; ++place) {
      const size_t row = slots.first_row[k / kTogether] + place;
      const gather::StoredHit hit = rows[row * kTogether + k % kTogether];
      if (hit.bits >> 15 != 0) out.push_back(hit);  // else it landed nowhere
    }
  }
};

/// Per element of a chunk, its slot, or none.
std::vector<std::optional<uint32_t>> slots_of_elements(const SlotChunk& slots) {
  std::vector<std::optional<uint32_t>> out(slots.end - slots.begin);
  for (uint32_t k = 0; k < slots.slots.size(); ++k) out[slots.slots[k].element - slots.begin] = k;
  return out;
}

}  // namespace

Status keep_chunk(const EndedChunk& chunk, const gpu::Buffer& landed, const ChunkKeeper& keeper) {
  if (!keeper.kept.wants()) return {};
  ChunkHits on_device{chunk.slots, {}};
  LUXEL_TRY(on_device.rows, gpu::downloaded<gather::StoredHit>(
                                keeper.commands, landed, chunk.slots.first_row.back() * kTogether,
                                "the buffer of what comes back"));
  const auto slot_of = slots_of_elements(chunk.slots);
  for (size_t t = 0; t < chunk.ended.size(); ++t) {
    const size_t first = t * gather::kTileElements;
    const gather::HitTile& ended = chunk.ended[t];
    gather::TracedTile tile;
    tile.rays = chunk.followed / chunk.ended.size();
    gather::HitTile& hits = tile.rays_met.hits;
    for (size_t k = 0; k < ended.end.size(); ++k) {
      if (const auto slot = slot_of[first + k]) {
        on_device.add(*slot, hits.entries);
        tile.rays += chunk.rays[*slot];
      }
      const auto more = ended.entries.begin();
      hits.entries.insert(hits.entries.end(), more + (k == 0 ? 0 : ended.end[k - 1]),
                          more + ended.end[k]);
      hits.end.push_back(uint32_t(hits.entries.size()));
    }
    gather::keep_tile(keeper.kept, (chunk.slots.begin + first) / gather::kTileElements, tile,
                      keeper.hits);
  }
  return {};
}

}  // namespace luxel::device
