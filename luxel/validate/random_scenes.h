// Random scenes that nobody tuned a solver for.
#pragma once

#include <cstdint>
#include <string>

#include "luxel/scene/scene.h"

namespace luxel::validate {

struct RandomScene {
  scene::Scene scene;
  std::string lamp;  ///< what lights it: "tiny", "huge", "point" or "sky"
};
/// A room of 1 to 10 m, with a sky instead of a ceiling in one of four. It holds plates a
/// ten-thousandth to a hundredth of the room above the floor, walls as thin, slivers as wide, and
/// boxes that stand on the floor. A square lamp measures a hundredth of the room or half of it.
/// The seed decides all.
RandomScene random_scene(uint64_t seed);

}  // namespace luxel::validate
