// A picture of a subject without a window.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "apps/view/subject.h"
#include "luxel/image/codec.h"

namespace luxel::view_window {

struct OffscreenParams {
  int width = 0, height = 0;       ///< 0: those of the first view
  std::optional<view::Play> play;  ///< then what is shown at its end
  std::string play_name;           ///< for messages
  int turn_frames = 0;             ///< > 0: so many pictures of a turn that begins there
};

/// Gets a picture, 3 channels, and its number in a turn; 0 where there is but one.
using TakePicture = std::function<Status(int number, const image::Image8&)>;

/// Draws a subject once its work is done, with a second bake `beside` it if there is one. Errors:
/// why there is nothing to see; a play of something else; no memory on the device; those of `take`.
Status draw_offscreen(gpu::Commands& commands, Subject& subject,
                      std::optional<view::OpenedBake> beside, const OffscreenParams& params,
                      const TakePicture& take);

}  // namespace luxel::view_window
