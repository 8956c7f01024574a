#include "apps/view/remembered.h"

#include <algorithm>

namespace luxel::view_window {

Remembered recall(const std::filesystem::path& file, const std::string& subject) {
  Remembered out;
  if (file.empty()) return out;
  const Result<view::Habits> habits = view::read_habits(file);
  if (!habits) return out.message = habits.error().message, out;
  out.file = file;
  out.subject = view::subject_of(*habits, subject);
  out.is_light = habits->is_light;
  out.layout = {habits->panel.place, habits->panel.open, habits->panel.closed};
  for (const view::SubjectHabits& known : habits->recent)
    if (known.path != subject) out.others.push_back(known.path);
  return out;
}

void begin_as_left(const Remembered& remembered, view::Walk& walk) {
  const view::SubjectHabits subject = view::moved_to(walk.origin, remembered.subject);
  walk.shown.camera = view::camera_to_begin(subject, walk.first.camera);
  walk.bookmarks = subject.bookmarks;
}

Status keep(const Remembered& remembered, const view::Walk& walk, const WindowLeft& window) {
  if (remembered.file.empty()) return {};
  LUXEL_TRY(view::Habits habits, view::read_habits(remembered.file));
  habits.is_light = window.is_light;
  habits.panel = {window.layout.place, window.layout.open, window.layout.closed};
  if (std::ranges::min(window.size) >= view::kSmallestWindow) habits.window = window.size;
  view::remember({remembered.subject.path, view::LastView{walk.first.camera, walk.shown.camera},
                  walk.bookmarks, walk.origin},
                 habits);
  return view::write_habits(habits, remembered.file);
}

std::optional<std::array<int, 2>> last_size(const std::filesystem::path& file) {
  const Result<view::Habits> habits = view::read_habits(file);
  return file.empty() || !habits ? std::nullopt : habits->window;
}

}  // namespace luxel::view_window
