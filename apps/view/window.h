// A bake in a window.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "luxel/base/result.h"
#include "luxel/view/model/events.h"
#include "luxel/view/open_bake.h"

namespace luxel::view_window {

struct WindowParams {
  std::string title;
  std::string device;  ///< gpu::DeviceParams::name
  int width = 960, height = 720;
  std::optional<view::Play> play;    ///< then the window closes
  std::filesystem::path screenshot;  ///< written at the end of a play; empty: none
};

/// Shows a bake until the window is closed. Errors (no_device): no display, no device that shows
/// pictures in a window; those of files.
Status show_in_window(const view::OpenedBake& bake, const WindowParams& params);

}  // namespace luxel::view_window
