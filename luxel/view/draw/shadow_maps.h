// Where lamps look for what is in the way of their light.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::view {

/// Depth as a lamp sees it: a square of a picture that holds those of all lamps.
struct ShadowMap {
  std::array<float, 16> clip_from_world{};  ///< column by column; depth 1 is nearest, 0 far away
  Vec2 corner;                              ///< its left upper pixel
  float side = 0;                           ///< [pixels]
  float texel_m = 0;  ///< width of a texel at 1 m before the lamp; of a directional one anywhere
  float depth_m = 0;  ///< of a directional one: what depths 0 and 1 are apart
  friend bool operator==(const ShadowMap&, const ShadowMap&) = default;
};

/// The maps of several lamps.
struct ShadowPlan {
  std::vector<ShadowMap> maps;
  std::vector<uint32_t> first_map;  ///< per lamp
  /// Per lamp. Those of a directional one show the more the later they come, the last one all.
  std::vector<uint32_t> map_count;
  /// Per lamp: six maps towards +x, -x, +y, -y, +z, -z; else one.
  std::vector<uint8_t> looks_all_round;
};

/// Maps in a square picture, as large as fits: at most kLargestShadowMap, and half of it for each
/// of six. Directional lamps see all of `bounds`; spots whose cone is narrow see it with one map.
/// Lamps for which no room is left have first_map = scene::kNone, and cast no shadows. Where all of
/// `bounds` makes texels that are wider than the pixels of what is near to `eye`, directional lamps
/// get further maps of that, as far as there is room. `picture_side` >= 2; null: no eye.
ShadowPlan plan_shadows(std::span<const scene::PunctualLight> lights, const Box3& bounds,
                        uint32_t picture_side, const trace::CameraRays* eye = nullptr);
inline constexpr uint32_t kLargestShadowMap = 2048;
inline constexpr size_t kMostNearMaps = 3;  ///< of a directional lamp, besides that of all

}  // namespace luxel::view
