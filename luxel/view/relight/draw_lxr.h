// A picture of an .lxr file, without a window.
#pragma once

#include "luxel/view/relight/lamp_desk.h"
#include "luxel/view/relight/relit_scene.h"

namespace luxel::view {

/// Whether a file is one by its name.
bool is_lxr(const std::filesystem::path& file);

/// What is shown at first, or where a play gets to, in the light that the lamps have then. Errors:
/// those of the device; a play of lamps that there are not, `play_name` is the file's.
Result<image::Image8> draw_lxr(gpu::Commands& commands, OpenedLxr& opened,
                               const std::optional<Play>& events, const std::string& play_name,
                               int width, int height);

}  // namespace luxel::view
