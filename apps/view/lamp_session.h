// The lamps of an .lxr file in a window: what the panel says of them, and light that follows.
#pragma once

#include <future>

#include "apps/view/lamp_panel.h"
#include "luxel/view/relight/lamp_check.h"
#include "luxel/view/relight/lamp_desk.h"
#include "luxel/view/relight/relit_scene.h"

namespace luxel::view_window {

struct LampSession {
  view::OpenedLxr opened;
  view::LampDrawing drawing;
  view::LampDesk desk;
  uint64_t lit = 0;  ///< view::LampDesk::changes that the picture shows
  int selected_glow = -1;
  std::vector<StageTimes> history = {};         ///< of the last pictures
  std::unique_ptr<view::LampCheck> check = {};  ///< null: nothing is compared
  std::string found = {};                       ///< by the last one that came to its end
  uint64_t found_of = 0;                        ///< view::LampDesk::changes that it is about
  /// Valid while an .lxr file is being written. The last: it looks at `opened`.
  std::future<Result<std::string>> saving = {};
};

LampSession begin_lamps(view::OpenedLxr opened, view::LampDrawing drawing);

/// The panel that shows this session.
LampPanel panel_of(const LampSession& session);
/// Applies the user's changes in the panel. New lamps are bright at this exposure.
void take_changes(const LampPanel& panel, float exposure, LampSession& session);

/// Begins to compare the light with the path tracer's, or stops that.
void begin_or_stop_check(LampSession& session);
/// Takes what was found. True: there is something.
bool take_check(LampSession& session);

/// Begins to write an .lxr file with the lamps as they are, in the background, if none is.
void begin_to_save_lxr(LampSession& session);
/// Outcome of writing that file, once: a sentence to be told. Errors: why it could not be written.
std::optional<Result<std::string>> take_saved(LampSession& session);

/// Light follows the lamps where they have changed, and maps of shadows the walk. Returns what it
/// took. Nothing may still draw the scene. Errors: the device is lost, no memory.
Result<view::LightTimes> light_lamps(gpu::Commands& commands, const view::Walk& walk,
                                     view::DeviceScene& scene, LampSession& session);
/// Keeps what a picture took; `draw_ms` is its drawing alone.
void add_times(const view::LightTimes& light, float draw_ms, LampSession& session);

}  // namespace luxel::view_window
