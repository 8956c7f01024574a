#include "apps/view/remembered.h"

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
  walk.shown.camera = view::camera_to_begin(remembered.subject, walk.first.camera);
  walk.bookmarks = remembered.subject.bookmarks;
}

Status keep(const Remembered& remembered, const view::Walk& walk, bool is_light,
            const PanelLayout& layout) {
  if (remembered.file.empty()) return {};
  LUXEL_TRY(view::Habits habits, view::read_habits(remembered.file));
  habits.is_light = is_light;
  habits.panel = {layout.place, layout.open, layout.closed};
  view::remember({remembered.subject.path, view::LastView{walk.first.camera, walk.shown.camera},
                  walk.bookmarks},
                 habits);
  return view::write_habits(habits, remembered.file);
}

}  // namespace luxel::view_window
