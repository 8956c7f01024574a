// The rays of all elements, traced once: for every ray, which place of the lightmap it met.
#pragma once

#include <bit>
#include <cstdint>

#include "luxel/base/row_store.h"
#include "luxel/base/vec.h"

namespace luxel::gather {

/// Where a ray met the lightmap, and how what it passed on the way coloured it: in 8 bytes, because
/// bounces read nothing else.
struct StoredHit {
  uint64_t bits = 0;

  /// Properties of the ray besides the place where it ended.
  struct Ray {
    uint32_t tint = 2047;      ///< what it passed, see pack_tint; 2047 is white
    bool second_half = false;  ///< which half of its element's samples it belongs to
    uint32_t doublings = 0;    ///< CellShares: it counts 2^-doublings
  };
  static constexpr uint32_t kSteps = 1023;  ///< parts of a texel
  /// `base`: the upper left of the four texels around the point, as an index into a map with a
  /// border of one texel, (y + 1) * (side + 2) + x + 1 < 2^29. `fx`, `fy`: how far the point is
  /// towards the lower right one, in 1/kSteps.
  static StoredHit pack(uint32_t base, uint32_t fx, uint32_t fy, Ray ray) {
    return {uint64_t(base) << 35 | uint64_t(fx) << 25 | uint64_t(fy) << 15 |
            uint64_t(ray.doublings) << 12 | uint64_t(ray.second_half) << 11 | ray.tint};
  }
  uint32_t base() const { return uint32_t(bits >> 35); }
  uint32_t fx() const { return uint32_t(bits >> 25) & kSteps; }
  uint32_t fy() const { return uint32_t(bits >> 15) & kSteps; }
  /// 2^-doublings.
  float weight() const { return std::bit_cast<float>((127 - (uint32_t(bits >> 12) & 7)) << 23); }
  bool second_half() const { return bits >> 11 & 1; }
  uint32_t tint() const { return uint32_t(bits) & 2047; }
};

/// A colour in 11 bits: 16 steps of red and green, 8 of blue. Rounded up or down by chance, so that
/// the mean over rays is the colour itself.
inline constexpr uint32_t kNoTint = 2047;
uint32_t pack_tint(Rgb color, uint64_t seed);
Rgb unpack_tint(uint32_t tint);

/// Rays that met no light are left out.
using HitTile = RowTile<StoredHit>;
using HitStore = RowStore<StoredHit>;
/// Elements per tile: few enough that many threads end at about the same time.
inline constexpr size_t kTileElements = 256;

}  // namespace luxel::gather
