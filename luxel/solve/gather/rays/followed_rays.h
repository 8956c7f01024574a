// Rays that were followed on (near_paths.h), as a bake keeps them for later ones: what each
// brought, and which way it took, so that it stays where neither can have changed.
// docs/method/rebake.md
#pragma once

#include <cstdint>
#include <span>

#include "luxel/base/vec.h"

namespace luxel::gather {

/// Where a followed ray went after it had met something near.
struct FollowedWay {
  /// It met a front and took one more step at most, whose direction is known.
  bool is_plain = false;
  Vec3 direction{};          ///< of that step, each component to kWayError; 0: it ended before
  bool has_hit = false;      ///< it read the map in the end: a StoredHit of its element is its own
  bool second_half = false;  ///< of its element's samples
};
/// Half a step of what is kept of a direction.
inline constexpr float kWayError = 0.5f / 511;

/// A ray that was followed on, in 16 bytes.
struct FollowedRay {
  Rgb light{};        ///< radiance that it brought, but for what it read in the map in the end
  uint32_t bits = 0;  ///< FollowedWay

  static FollowedRay pack(Rgb light, const FollowedWay& way);
  FollowedWay way() const;
  bool has_hit() const { return bits >> 30 & 1; }
};

}  // namespace luxel::gather
