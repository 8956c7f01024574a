// Random scenes that nobody tuned a solver for.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "luxel/scene/scene.h"

namespace luxel::validate {

/// The hard thing about a scene.
enum class Hard : uint8_t {
  nothing,   ///< a room of boxes, plates, walls and slivers
  slats,     ///< direct light falls through a row of slats, or through rings
  masks,     ///< sheets with holes hang in it
  overlaps,  ///< TEXCOORD_1 has charts that share the texels at their borders
  far,       ///< it lies up to eight times its size from the origin, as far as no reader moves it
  road,      ///< a strip of ground, 30 to 400 times as long as the room, passes it
  white,     ///< all surfaces reflect 0.99
  barriers,  ///< walls thinner than texels part it from wall to wall
};
inline constexpr std::array kHard{Hard::slats, Hard::masks, Hard::overlaps, Hard::far,
                                  Hard::road,  Hard::white, Hard::barriers};
/// "slats", ...
const char* name_of(Hard hard);

struct RandomScene {
  scene::Scene scene;
  std::string lamp;  ///< what lights it: "tiny", "huge", "point" or "sky"
};
/// A room of 1 to 10 m, with a sky instead of a ceiling in one of four. It holds plates a
/// ten-thousandth to a hundredth of the room above the floor, walls as thin, slivers as wide, and
/// boxes that stand on the floor. A square lamp measures a hundredth of the room or half of it.
/// The seed decides all. What is hard is added to a room of its own; white rooms have a ceiling,
/// and roads a sky.
RandomScene random_scene(uint64_t seed, Hard hard = Hard::nothing);

}  // namespace luxel::validate
