// Several models in one scene.
#pragma once

#include <span>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Everything of all of them, each where it stands in its own: instances, lights and cameras, with
/// what they refer to. The origin is that of the first. Surroundings are those of the first that
/// has any. The name is that of the first.
Scene merged(std::span<const Scene> scenes);

}  // namespace luxel::scene
