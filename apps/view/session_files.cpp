#include "apps/view/session_files.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace luxel::view_window {
namespace {

/// So often it is looked whether files have changed.
constexpr double kLook_s = 0.5;

/// The panel of another subject: what the user has made of it stays.
Panel panel_for(const Session& s) {
  Panel out;
  out.title = title_of(s.path), out.about = s.panel.about;
  out.keys_open = s.panel.keys_open, out.is_light = s.panel.is_light;
  out.layout = s.panel.layout;
  out.keys = s.keys, out.recent = s.remembered.others;
  out.message = s.remembered.message;
  return out;
}

/// A newly opened subject takes the place of the shown one.
Status show_next(std::unique_ptr<Subject> subject, const std::filesystem::path& path, Session& s) {
  if (const Status kept = keep_habits(s); !kept) s.remembered.message = kept.error().message;
  const bool is_same = full_path(path) == s.path;
  s.carried = is_same ? s.walk : std::nullopt;
  const gpu::Device& device = *s.screen.device;
  device.vk.vkDeviceWaitIdle(device.device);
  s.screen.looking = {}, s.screen.looking_beside = {};
  s.screen.pair.reset(), s.screen.beside = nullptr;
  s.subject = std::move(subject);
  s.screen.additions = s.subject->additions();
  s.shows_scene = false, s.still_frames = 0;
  s.walk.reset();
  s.path = full_path(path);
  s.watch = view::watch_file(s.path);
  s.remembered = recall(s.params.habits, s.path);
  s.keys = key_lines(*s.subject);
  s.panel = panel_for(s);
  if (is_same) s.panel.message = "opened again: the file has changed";
  glfwSetWindowTitle(s.window.get(), s.panel.title.c_str());
  return {};
}

/// Files that have changed are opened again at once where nothing is lost by that.
void look_at_files(Session& s) {
  if (s.next || seconds_since(s.last_look) < kLook_s) return;
  s.last_look = Clock::now();
  if (!view::has_changed(s.watch)) return;
  if (s.subject->follows_its_file())
    open_in_window(s.path, s);
  else
    s.panel.offers_again = true;
}

}  // namespace

void open_in_window(const std::filesystem::path& path, Session& s) {
  s.still_frames = 0;
  s.panel.offers_again = false;
  Result<NextSubject> next = begin_next(path, s.params.open, *s.screen.commands);
  if (!next) {
    s.panel.message = next.error().message;
    return;
  }
  s.next = std::move(*next);
  s.panel.message = "opening " + title_of(path);
}

bool is_opening(const Session& s) { return s.next.has_value(); }

Result<bool> follow_files(Session& s) {
  for (const std::filesystem::path& path : s.window.dropped()) open_in_window(path, s);
  if (const int recent = std::exchange(s.panel.opens, -1); recent >= 0)
    open_in_window(std::filesystem::path(s.remembered.others[size_t(recent)]), s);
  if (std::exchange(s.panel.asks_again, false)) open_in_window(s.path, s);
  look_at_files(s);
  if (!s.next) return false;
  Result<std::unique_ptr<Subject>> subject = take_next(*s.screen.commands, *s.next);
  if (subject && !*subject) return false;
  const std::filesystem::path path = s.next->path;
  if (!subject) {
    s.panel.message = subject.error().message;
    s.next.reset();
    return true;
  }
  s.next.reset();
  LUXEL_TRY_STATUS(show_next(std::move(*subject), path, s));
  return true;
}

Status keep_habits(const Session& s) {
  if (!s.walk) return {};
  const float scale = std::max(s.window.scale(), 0.1f);
  const auto [width, height] = s.window.pixels();
  const std::array size{int(std::lround(float(width) / scale)),
                        int(std::lround(float(height) / scale))};
  return keep(s.remembered, *s.walk, {s.panel.is_light, s.panel.layout, size});
}

}  // namespace luxel::view_window
