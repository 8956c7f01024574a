// The lamps of an .lxr file as the user has them now.
#pragma once

#include <string>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/solve/matrix/relight_data.h"
#include "luxel/view/lamp.h"

namespace luxel::view {

/// A material of the .lxr file that glows, or could.
struct Glow {
  std::string name;
  Rgb radiance{};  ///< L, its mean over the material's surfaces [W/(sr m^2)]
  bool is_on = true;
};

/// All that shines.
struct Lamps {
  std::vector<Lamp> lamps;
  std::vector<Glow> glows;  ///< of each material of the file
  Rgb background{};         ///< radiance of the surroundings [W/(sr m^2)]
};

/// As they were baked.
Lamps lamps_of(const matrix::RelightData& data);

/// Those lamps that are on.
std::vector<scene::PunctualLight> shining(const Lamps& lamps);
/// L of each material of the file; 0 of those that are off.
std::vector<Rgb> glowing(const Lamps& lamps);

/// True: a lamp, a glow or the background gives light.
bool has_light(const Lamps& lamps);

/// The emission of a material of the file's scene: as baked, but by as much brighter as its glow is
/// than it was; where it did not glow, its glow.
Rgb emission_now(const scene::Material& material, const Lamps& now, const Lamps& baked);

}  // namespace luxel::view
