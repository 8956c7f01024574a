// Shape of gizmos: all that is drawn of them can be taken.
#pragma once

#include <vector>

#include "luxel/view/edit/gizmo.h"

namespace luxel::view {

/// From the eye to the gizmo, of unit length.
Vec3 towards(const Gizmo& gizmo, const Walk& walk);
/// The ring about an axis, in small steps [m].
std::vector<Vec3> ring_of(const Gizmo& gizmo, int axis, const Walk& walk);
/// True where a place of a ring is on its far side.
bool is_behind(const Gizmo& gizmo, Vec3 place, const Walk& walk);

}  // namespace luxel::view
