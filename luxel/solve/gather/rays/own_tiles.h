// Gives the results that members of a team have for their own tiles to all others.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "luxel/base/share_out.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {

/// Tiles whose hits are here, ascending.
inline std::vector<uint32_t> own_tiles(const TracedHits& hits) {
  std::vector<uint32_t> out;
  for (uint32_t t = 0; t * kTileElements < hits.size(); ++t)
    if (has_tile(hits, t)) out.push_back(t);
  return out;
}

/// The values of a tile's elements, so many each.
template <class T>
std::span<T> of_tile(std::span<T> values, size_t tile, size_t elements, size_t per_element = 1) {
  const size_t begin = tile * kTileElements, end = std::min(begin + kTileElements, elements);
  return values.subspan(begin * per_element, (end - begin) * per_element);
}

/// Each member has filled arrays for elements of its own tiles, `per_element` values each: fills
/// them for all. Nothing happens without a team. Errors: those of exchange().
template <class... T>
Status give_own_tiles(const TracedHits& hits, size_t per_element, Progress& progress,
                      std::span<T>... arrays) {
  if (!hits.team) return {};
  const auto each = [&](size_t t, const auto& visit) {
    (visit(of_tile(arrays, t, hits.size(), per_element)), ...);
  };
  return exchange(hits.team, own_tiles(hits),
                  {hits.owner.size(),
                   [&](size_t t, ByteWriter& out) {
                     each(t, [&](auto part) { out.put(std::as_bytes(part)); });
                   },
                   [&](size_t t, uint32_t, ByteReader& in) {
                     each(t, [&](auto part) { in.get(std::as_writable_bytes(part)); });
                     return in.ok;
                   }},
                  progress);
}

}  // namespace luxel::gather
