// A window while it is open: a bake that is there, one that is being made, or lamps that
// are moved.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "luxel/base/result.h"
#include "luxel/view/live/live_bake.h"
#include "luxel/view/model/events.h"
#include "luxel/view/open_bake.h"
#include "luxel/view/relight/open_lxr.h"

namespace luxel::view_window {

struct WindowParams {
  std::string title;
  std::string subject;           ///< absolute path of what is shown
  std::filesystem::path habits;  ///< view::habits_file(); empty: nothing is remembered
  std::string device;            ///< gpu::DeviceParams::name
  int width = 960, height = 720;
  std::optional<view::Play> play;    ///< then the window closes
  std::string play_name;             ///< for messages
  std::filesystem::path screenshot;  ///< written at the end of a play; empty: none
  /// A table of a play's frames: .csv; empty: none.
  std::filesystem::path frame_table;
};

/// Shows a bake until the window is closed, with a second one `beside` it. Errors (no_device): no
/// display, no device that shows pictures in a window; those of files.
Status show_in_window(view::OpenedBake bake, std::optional<view::OpenedBake> beside,
                      const WindowParams& params);
/// Bakes a scene and shows it meanwhile and afterwards, until the window is closed. A bake that
/// fails says so in the window. Errors as above.
Status bake_in_window(const pipeline::BakeSettings& settings, const WindowParams& params);

/// Shows an .lxr file whose lamps can be moved, until the window is closed. Errors as above; a play
/// of lamps that there are not.
Status relight_in_window(view::OpenedLxr opened, const WindowParams& params);

}  // namespace luxel::view_window
