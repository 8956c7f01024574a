// The rays of all elements, traced once: for every ray, which place of the lightmap it met.
#pragma once

#include "transport/row_store.h"

namespace luxel::gather {

/// Where a ray met the lightmap: the upper left of the four texels around the point, and how far
/// the point is towards the lower right one, in 1/65535 of a texel.
struct StoredHit {
  uint32_t base = 0;  ///< index into a map with a border of one texel: (y + 1) * (side + 2) + x + 1
  uint16_t fx = 0, fy = 0;

  /// Which half of its element's samples the ray belongs to, kept in the lowest bit of fx.
  bool second_half() const { return fx & 1; }
};
static_assert(sizeof(StoredHit) == 8);

/// Rays that met no light are left out.
using HitTile = transport::RowTile<StoredHit>;
using HitStore = transport::RowStore<StoredHit>;
/// Elements per tile: few enough that many threads end at about the same time.
inline constexpr size_t kTileElements = 256;

}  // namespace luxel::gather
