// A scene that is edited in a window: tools, what the panel says of them, and saving.
#pragma once

#include <future>
#include <optional>

#include "apps/view/panel.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/view/edit/drawn_edits.h"
#include "luxel/view/edit/tools.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view_window {

struct EditSession {
  view::EditTools tools;
  pipeline::BakeSettings settings;               ///< of the scene's file
  std::vector<EditChoice> instances, materials;  ///< of the scene as it was read
  std::array<char, 96> sun{};                    ///< what was typed last
  std::vector<uint32_t> of_material;             ///< view::materials_as_read() of what is drawn
  bool has_put = false;                          ///< what is drawn has the edits that `put` counts
  uint64_t put = 0;                              ///< of EditDesk::changes
  std::future<Result<std::string>> saving;       ///< valid while it goes on
  std::string told;                              ///< of what was saved last
  std::string failed;                            ///< the first thing of a play that failed
};

/// `read`: the scene as it was read, before all edits.
EditSession begin_edits(std::shared_ptr<const view::ReadScene> read,
                        const pipeline::BakeSettings& settings);

EditPanel panel_of(const EditSession& session);
/// Keys of its own, for F1.
std::vector<KeyLine> edit_keys();
/// Applies the user's changes in the panel. New lamps are bright at this exposure.
void take_changes(const EditPanel& panel, float exposure, EditSession& session);

/// The device now has another scene, which needs the edits anew.
void has_another(EditSession& session);
/// The scene and the frame follow the edits. Nothing may still draw the scene.
void show_edits(const view::Walk& walk, view::ShownScene& shown, view::Frame& frame,
                EditSession& session);

/// Begins to write the edited scene into the output folder, in the background.
void save_edited(EditSession& session);
bool is_saving(const EditSession& session);
/// News of saving, and of events that failed; empty: nothing is to be told.
std::string news_of(EditSession& session);
/// Returns when it is saved, with what is to be told. Errors: what could not be done.
Result<std::string> end_edits(EditSession& session);

}  // namespace luxel::view_window
