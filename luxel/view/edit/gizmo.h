// Handles by which what is selected is moved, turned and scaled.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "luxel/view/mark.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

enum class Tool : uint8_t { move, turn, scale };
inline constexpr std::array<const char*, 3> kTools{"move", "turn", "scale"};

/// Parts of a gizmo that can be taken hold of. x, y and z go along an axis, or around it; yz, zx
/// and xy go along two axes, at a right angle to the third; `all`, the middle, goes along all.
enum class Grip : uint8_t { x, y, z, yz, zx, xy, all };

/// It is of the same size on the screen wherever it stands.
struct Gizmo {
  Tool tool = Tool::move;
  Vec3 centre;  ///< [m]
  Mat34 axes;   ///< orthonormal; of moves and turns those of the world
};

/// The size of a gizmo in a picture, from its centre to the ends of its axes [pixels].
float gizmo_reach(const Walk& walk);

/// The nearest grip within reach of a pixel; none where there is none.
std::optional<Grip> grip_at(const Gizmo& gizmo, const Walk& walk, Vec2 pixel);
/// As it is seen, over the picture. One grip may be lit.
std::vector<Mark> marks_of(const Gizmo& gizmo, std::optional<Grip> lit, const Walk& walk);

/// Steps in which what is dragged goes on; 0: evenly.
struct Snap {
  float move_m = 0, turn_rad = 0, scale = 0;
};
/// For a scene of this size: about a hundredth of it as 1, 2 or 5 times a power of ten; 15 degrees;
/// a tenth.
Snap snap_of(const Box3& bounds);

/// The transform of the world by a drag of a grip from a pixel to another: it takes p to its new
/// place. A drag along an axis goes to the place of the axis that is nearest to the pointer's ray,
/// one in a plane to the place where that ray meets the plane.
Mat34 dragged_by(const Gizmo& gizmo, Grip grip, Vec2 from, Vec2 to, const Snap& snap,
                 const Walk& walk);

}  // namespace luxel::view
