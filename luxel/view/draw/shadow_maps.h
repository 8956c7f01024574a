// Where lamps look for what is in the way of their light.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"

namespace luxel::view {

/// Depth as a lamp sees it: a square of a picture that holds those of all lamps.
struct ShadowMap {
  std::array<float, 16> clip_from_world{};  ///< column by column; depth 1 is nearest, 0 far away
  Vec2 corner;                              ///< its left upper pixel
  float side = 0;                           ///< [pixels]
  float texel_m = 0;  ///< width of a texel at 1 m before the lamp; of a directional one anywhere
  friend bool operator==(const ShadowMap&, const ShadowMap&) = default;
};

/// The maps of several lamps.
struct ShadowPlan {
  std::vector<ShadowMap> maps;
  std::vector<uint32_t> first_map;  ///< per lamp
  /// Per lamp: six maps towards +x, -x, +y, -y, +z, -z; else one.
  std::vector<uint8_t> looks_all_round;
};

/// Maps in a square picture, as large as fits: at most kLargestShadowMap, and half of it for each
/// of six. Directional lamps see all of `bounds`; spots whose cone is narrow see it with one map.
/// Lamps for which no room is left have first_map = scene::kNone, and cast no shadows.
/// `picture_side` >= 2.
ShadowPlan plan_shadows(std::span<const scene::PunctualLight> lights, const Box3& bounds,
                        uint32_t picture_side);
inline constexpr uint32_t kLargestShadowMap = 2048;

}  // namespace luxel::view
