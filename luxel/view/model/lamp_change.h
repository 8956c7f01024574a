// Changes of lamps by events.
#pragma once

#include "luxel/view/lamp.h"
#include "luxel/view/model/events.h"

namespace luxel::view {

/// `origin`: of the scene.
void change(const LampChange& by, DVec3 origin, Lamp& lamp);
/// A lamp of its own name; without a place of its own it is in the middle of the scene's bounds.
Lamp new_lamp(const LampAdded& added, const Box3& bounds, DVec3 origin);

}  // namespace luxel::view
