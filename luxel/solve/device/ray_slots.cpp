#include "luxel/solve/device/ray_slots.h"

#include <algorithm>
#include <functional>
#include <unordered_map>

#include "luxel/base/check.h"
#include "luxel/solve/device/device_elements.h"

namespace luxel::device {
namespace {

constexpr size_t kWordsOfShares = 8, kCellsOfWord = gather::kCells / kWordsOfShares;

/// Shares of cells that the slots of a round have, each of them once.
class SharesInUse {
 public:
  explicit SharesInUse(const gather::TracedHits& hits) : hits_(hits) {}

  /// RaySlot::shares of an element.
  uint32_t of(size_t element) {
    if (!gather::is_guided(hits_, element)) return 0;
    const uint32_t group = hits_.guide.of_element[element];
    const int level = hits_.guided[element];
    const auto [found, is_new] =
        number_.try_emplace(uint64_t(group) << 8 | uint64_t(level), uint32_t(all_.size()));
    if (is_new) all_.push_back(gather::shares_at(hits_.guide.groups[group], level));
    return found->second + 1;
  }
  const gather::CellShares& at(uint32_t shares) const { return all_[shares - 1]; }
  std::vector<uint32_t> words() const {
    std::vector<uint32_t> out;
    for (const gather::CellShares& shares : all_)
      for (size_t w = 0; w < kWordsOfShares; ++w) {
        uint32_t word = 0;
        for (size_t c = 0; c < kCellsOfWord; ++c)
          word |= uint32_t(shares.doublings[w * kCellsOfWord + c]) << (4 * c);
        out.push_back(word);
      }
    return out;
  }

 private:
  const gather::TracedHits& hits_;
  std::unordered_map<uint64_t, uint32_t> number_;
  std::vector<gather::CellShares> all_;
};

/// As many as samples have rays; or, where some cells have more of them than others and a range is
/// not one of whole blocks of 64, of which each cell has one sample, a few more.
uint32_t places_with(const gather::CellShares& shares, gather::Samples samples) {
  constexpr auto kBlock = uint32_t(gather::kCells);
  uint32_t out = 0;
  for (const uint8_t doublings : shares.doublings) {
    const gather::Samples own = samples.doubled(doublings);
    out += (own.end + kBlock - 1) / kBlock - own.first / kBlock;
  }
  return out;
}

/// Sorts a chunk's slots and makes its rows.
void finish(SlotChunk& chunk) {
  std::ranges::stable_sort(chunk.slots, std::greater{}, &on_device::RaySlot::places);
  for (size_t k = 0; k < chunk.slots.size(); k += kTogether)
    chunk.first_row.push_back(chunk.first_row.back() + chunk.slots[k].places);
}

}  // namespace

RoundSlots slots_of_round(std::span<const uint16_t> target, const gather::TracedHits& hits,
                          uint64_t places_of_chunk) {
  LUXEL_CHECK(target.size() == hits.size());
  RoundSlots out;
  SharesInUse in_use(hits);
  SlotChunk chunk;
  uint64_t places = 0;
  for (size_t begin = 0; begin < target.size(); begin += gather::kTileElements) {
    const size_t end = std::min(begin + gather::kTileElements, target.size());
    for (size_t i = begin; i < end; ++i) {
      const gather::Samples samples{hits.samples[i], std::max(hits.samples[i], target[i])};
      if (samples.count() == 0) continue;
      on_device::RaySlot slot{uint32_t(i), samples.first, samples.end, in_use.of(i),
                              samples.count()};
      if (slot.shares > 0) slot.places = places_with(in_use.at(slot.shares), samples);
      chunk.slots.push_back(slot);
      places += slot.places, out.samples += samples.count();
    }
    chunk.end = end;
    // The next tile may have as many places as this one on average.
    const uint64_t tiles = (end - chunk.begin + gather::kTileElements - 1) / gather::kTileElements;
    if (end < target.size() && places + places / tiles <= places_of_chunk) continue;
    if (!chunk.slots.empty()) {
      finish(chunk);
      out.chunks.push_back(std::move(chunk));
    }
    chunk = {}, chunk.begin = end, places = 0;
  }
  out.shares = in_use.words();
  return out;
}

}  // namespace luxel::device
