// A window while it is open.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/view/subject.h"
#include "luxel/base/result.h"
#include "luxel/view/model/events.h"
#include "luxel/view/open_bake.h"

namespace luxel::view_window {

struct WindowParams {
  std::string title;
  std::string subject;           ///< absolute path of what is shown
  std::filesystem::path habits;  ///< view::habits_file(); empty: nothing is remembered
  OpenSubject open;              ///< what takes its place when it is asked for
  std::string device;            ///< gpu::DeviceParams::name
  int width = 960, height = 720;
  std::optional<view::Play> play;    ///< then the window closes
  std::string play_name;             ///< for messages
  std::filesystem::path screenshot;  ///< written at the end of a play; empty: none
  /// A table of a play's frames: .csv; empty: none.
  std::filesystem::path frame_table;
};

/// Shows a subject until the window is closed, with a second bake `beside` it if there is one. Work
/// that fails says so in the window. Errors (no_device): no display, no device that shows pictures
/// in a window; those of files; a play of something else.
Status show_in_window(const MakeSubject& make_subject, std::optional<view::OpenedBake> beside,
                      const WindowParams& params);

}  // namespace luxel::view_window
