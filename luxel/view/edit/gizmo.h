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

/// What of a gizmo can be taken hold of: what goes along an axis, or around it; what goes along two
/// axes, at a right angle to the third; and the middle, which goes along all.
enum class Grip : uint8_t { x, y, z, yz, zx, xy, all };

/// It is of the same size on the screen wherever it stands.
struct Gizmo {
  Tool tool = Tool::move;
  Vec3 centre;  ///< [m]
  Mat34 axes;   ///< orthonormal; of moves and turns those of the world
};

/// The size of a gizmo in a picture, from its centre to the ends of its axes [pixels].
float gizmo_reach(const Walk& walk);

/// What is within reach of a pixel, the nearest; none where nothing is.
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

/// What a drag of a grip from a pixel to another does to the world: what was at p is then at the
/// result of p. Along an axis it goes to the place of the axis that is nearest to what is under the
/// pointer, in a plane to what is under the pointer itself.
Mat34 dragged_by(const Gizmo& gizmo, Grip grip, Vec2 from, Vec2 to, const Snap& snap,
                 const Walk& walk);

}  // namespace luxel::view
