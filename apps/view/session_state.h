// A window while it is open: what its parts share.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/view/frame_table.h"
#include "apps/view/next_subject.h"
#include "apps/view/remembered.h"
#include "apps/view/screen.h"
#include "apps/view/session.h"
#include "luxel/view/model/play.h"
#include "luxel/view/model/walk.h"

namespace luxel::view_window {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

/// Keys and buttons, those of the subject first.
std::vector<KeyLine> key_lines(const Subject& subject);

/// A window while it is open.
struct Session {
  Window& window;
  Screen& screen;
  std::unique_ptr<Subject> subject;
  const WindowParams& params;
  std::string path = params.subject;  ///< of what is shown
  Remembered remembered = recall(params.habits, path);
  std::vector<KeyLine> keys = key_lines(*subject);
  std::vector<std::string> views = {};  ///< names of the scene's cameras
  Panel panel = {};
  std::optional<view::Walk> walk = {};     ///< once there is a scene, and the window has a size
  std::optional<view::Walk> carried = {};  ///< how to go on where the same file is opened again
  view::PlaceSeen place_seen = {};
  int still_frames = 0;      ///< since something changed
  bool fits = false;         ///< what is drawn with is of the window's size
  bool shows_scene = false;  ///< and of the scene
  view::Played played = {};
  bool play_waits = false;  ///< for the background
  FrameTable table = {};
  Clock::time_point last = Clock::now(), last_report = Clock::now();

  std::optional<float> scale = {};       ///< of a play; none: the monitor's
  std::optional<NextSubject> next = {};  ///< that is being opened
  view::FileWatch watch = view::watch_file(path);
  Clock::time_point last_look = Clock::now();  ///< at the files
};

}  // namespace luxel::view_window
