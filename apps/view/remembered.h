// A window begins with what the last one has left, and leaves what the next one begins with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/view/panel.h"
#include "luxel/view/model/habits.h"
#include "luxel/view/model/walk.h"

namespace luxel::view_window {

struct Remembered {
  std::filesystem::path file;  ///< empty: nothing is remembered
  view::SubjectHabits subject;
  std::vector<std::string> others;  ///< subjects, the newest first
  bool is_light = false;
  PanelLayout layout;
  std::string message;  ///< why nothing is remembered
};

/// `file` may be empty. One that is broken is left as it is.
Remembered recall(const std::filesystem::path& file, const std::string& subject);

/// Where a walk that has just begun goes on.
void begin_as_left(const Remembered& remembered, view::Walk& walk);

/// State that a window leaves besides its walk.
struct WindowLeft {
  bool is_light = false;
  const PanelLayout& layout;
  std::array<int, 2> size;  ///< Habits::window
};
/// Leaves what the walk has come to. What windows of other subjects have left meanwhile stays.
/// Errors: those of files.
Status keep(const Remembered& remembered, const view::Walk& walk, const WindowLeft& window);

/// Habits::window of the last window; none where none is known.
std::optional<std::array<int, 2>> last_size(const std::filesystem::path& file);

}  // namespace luxel::view_window
