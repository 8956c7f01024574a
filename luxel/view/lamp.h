// A lamp that can be changed.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::view {

/// A point, spot or directional light.
struct Lamp {
  scene::PunctualLight light;
  bool is_on = true;
  bool is_deleted = false;  ///< it keeps its number, and is neither lit nor seen
};

}  // namespace luxel::view
