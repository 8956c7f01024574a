// Surfaces that no light reaches.
#pragma once

#include <string>

#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// A sentence for a bake whose surfaces are all black, or a fifth of them and more in a scene that
/// is lit from outside alone: rooms that are closed. Otherwise empty. Texels inside solids do not
/// count.
std::string about_dark_surfaces(const Bake& bake);

}  // namespace luxel::pipeline
