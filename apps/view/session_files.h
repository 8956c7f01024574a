// The files of a window: another one that is opened, one that has changed, what is remembered.
#pragma once

#include "apps/view/session_state.h"

namespace luxel::view_window {

/// Begins to open another file or folder in the place of the shown one, or the same one again. If
/// that fails, the panel says why, and the shown one stays.
void open_in_window(const std::filesystem::path& path, Session& s);
/// True while another file is being opened.
bool is_opening(const Session& s);

/// Files that were dropped on the window; what has been opened takes the place of what is shown;
/// what has changed on disk is opened again, or that is offered. True: something is to be drawn.
/// Errors: no memory on the device.
Result<bool> follow_files(Session& s);

/// Leaves what the window has come to. Errors: those of files.
Status keep_habits(const Session& s);

}  // namespace luxel::view_window
