// The light of a mesh as far as it is known, while its elements look around one by one.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/hemicube/look.h"

namespace luxel::view {

/// Light of a mesh while a solver works on it.
struct GrowingLight {
  std::vector<Rgb> reflectance;  ///< per element
  std::vector<Rgb> irradiance;   ///< E per element as far as it is known [W/m^2]
  std::vector<Rgb> sent;         ///< B that elements see in this pass
  bool has_light = false;        ///< of a pass before, or straight from lights
};

/// A mesh with the light that it has by now; dark where that is empty.
GrowingLight begin_growing(std::span<const Rgb> reflectance, std::span<const Rgb> irradiance);
/// A pass begins with light straight from lights, which is shown where there is none from a pass
/// before. What elements see is what the others have now.
void begin_pass(std::span<const Rgb> direct, GrowingLight& light);
/// An element has looked around: its light is E_0 and what it gathers.
/// [Rodriguez06, General Radiosity Algorithm, 3]
void reach(size_t element, Rgb source, const hemicube::View& view, GrowingLight& light);
/// All have light of one bounce more.
void take_bounce(std::span<const Rgb> irradiance, GrowingLight& light);

}  // namespace luxel::view
