// Cuts charts where something stands on them that parts the light.
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/plane.h"

namespace luxel::atlas {

/// Two places of one chart about a texel apart, and the plane of what stands between them.
struct PartedPoints {
  uint32_t chart = 0;
  Vec3 a, b;  ///< on the surface, world [m]
  Plane between;
};

/// A scene whose charts have been cut.
struct CutScene {
  scene::Scene scene;
  /// Per drawn triangle: triangles of different groups must not share a chart
  /// (AtlasParams::group).
  std::vector<uint32_t> group;
  uint32_t cuts = 0;  ///< planes used; 0: the scene is as it was
};

/// Divides the triangles of each chart along planes until no plane parts kFewestParted pairs in one
/// piece any more: the plane that parts most pairs first, each piece for itself (a binary space
/// partition). A plane that would cut more triangles than it parts pairs is left out: tufts of
/// grass would become finer than texels. Pieces that no pair connects may share a group, so a house
/// on a lawn cuts it into the part inside and the part outside. Planes cut what lies near the
/// pairs; other triangles of the piece, and those smaller than half a texel, go to one side whole.
/// In the end no more vertices are left than the borders of groups need
/// (luxel/scene/join_pieces.h), and no new T-junctions (luxel/scene/t_junctions.h). An instance
/// that shares its mesh gets one of its own. `atlas` is that of `scene`. `group` is that of an
/// earlier cut, AtlasParams::group of the atlas: its groups stay apart.
CutScene cut_charts(scene::Scene scene, const Atlas& atlas, std::span<const PartedPoints> parted,
                    std::span<const uint32_t> group = {});

/// As many as a barrier parts that crosses a strip one texel wide: two neighbours, and two next
/// neighbours on each side.
inline constexpr size_t kFewestParted = 3;

}  // namespace luxel::atlas
