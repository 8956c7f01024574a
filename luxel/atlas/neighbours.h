// Elements that lie beside one another in the map.
#pragma once

#include <algorithm>
#include <cstdint>

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {

/// Calls visit(element) for those at most `reach` texels from element i along each axis, itself
/// included, row by row, of whatever chart they are.
template <class Visit>
void for_neighbours(const TexelMap& map, size_t i, int reach, const Visit& visit) {
  const int side = map.resolution, x = int(map.texels[i].x), y = int(map.texels[i].y);
  for (int v = std::max(0, y - reach); v <= std::min(side - 1, y + reach); ++v) {
    const uint32_t* row = map.texel_at.data() + size_t(v) * size_t(side);
    for (int u = std::max(0, x - reach); u <= std::min(side - 1, x + reach); ++u)
      if (row[u] != kNone) visit(row[u]);
  }
}

}  // namespace luxel::atlas
