// What a picture of the viewer shows.
#pragma once

#include <vector>

#include "luxel/display/tone_map.h"
#include "luxel/scene/scene.h"
#include "luxel/view/mark.h"

namespace luxel::view {

/// What of surfaces is shown.
enum class Show : uint32_t {
  light_and_colour,  ///< what they send to the eye
  light,             ///< as if all surfaces were white
  colour,            ///< their reflectance, whatever falls on them
};

/// One picture.
struct Frame {
  scene::Camera camera;
  float exposure = 1;  ///< factor of the radiance before the curve
  display::ToneMap curve = display::ToneMap::shoulder;
  Show show = Show::light_and_colour;
  std::vector<Mark> marks;  ///< over the picture, the last one uppermost
};

}  // namespace luxel::view
