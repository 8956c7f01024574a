// A picture of a subject without a window.
#pragma once

#include <optional>
#include <string>

#include "apps/view/subject.h"
#include "luxel/image/codec.h"

namespace luxel::view_window {

struct OffscreenParams {
  int width = 0, height = 0;       ///< 0: those of the first view
  std::optional<view::Play> play;  ///< then what is shown at its end
  std::string play_name;           ///< for messages
};

/// What a subject shows once its work is done, with a second bake `beside` it if there is one: 3
/// channels. Errors: why there is nothing to see; a play of something else; no memory on the
/// device.
Result<image::Image8> draw_offscreen(gpu::Commands& commands, Subject& subject,
                                     std::optional<view::OpenedBake> beside,
                                     const OffscreenParams& params);

}  // namespace luxel::view_window
