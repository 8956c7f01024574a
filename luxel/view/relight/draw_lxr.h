// A picture of an .lxr file, without a window.
#pragma once

#include "luxel/image/codec.h"
#include "luxel/view/relight/lamp_desk.h"
#include "luxel/view/relight/relit_scene.h"

namespace luxel::view {

/// How a picture is asked for.
struct LxrPicture {
  int width = 0, height = 0;   ///< 0: those of the first view
  std::optional<Play> events;  ///< then what is shown at their end
  std::string play_name;       ///< for messages
};

/// What is seen in the light that the lamps have then. Errors: those of the device; a play of lamps
/// that there are not.
Result<image::Image8> draw_lxr(gpu::Commands& commands, OpenedLxr& opened,
                               const LxrPicture& wanted);

}  // namespace luxel::view
