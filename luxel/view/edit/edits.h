// Changes of a scene, and their undoing.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/view/lamp.h"
#include "luxel/view/model/events.h"
#include "luxel/view/read_scene.h"

namespace luxel::view {

// Kinds of edits. Instances, materials and lamps have the numbers that they have in the scene as it
// was read. Lamps that were added have the numbers that follow. Numbers stay whatever is deleted.
// Each edit says all of what it changes: done once or twice, it leaves the same scene.
struct InstanceMoved {
  uint32_t instance = 0;
  Mat34 world_from_object;
};
struct LampSet {
  uint32_t lamp = 0;
  scene::PunctualLight light;
  bool is_on = true;
  std::optional<SkyAsked> sky{};  ///< that it is the sun of from now on; none: no other one
};
struct LampCreated {
  scene::PunctualLight light;
};
struct LampDeleted {
  uint32_t lamp = 0;
};
struct MaterialSet {
  uint32_t material = 0;
  Rgb base_color{1, 1, 1};  ///< scene::Material::base_color
  Rgb emission{};           ///< scene::Material::emission [W/(sr m^2)]
  float metallic = 0;       ///< scene::Material::metallic
};
using Edit = std::variant<InstanceMoved, LampSet, LampCreated, LampDeleted, MaterialSet>;

/// Edits done and edits undone, without a limit.
struct History {
  std::vector<Edit> done, undone;  ///< the last ones are the next to be undone, and done again
  bool is_open = false;            ///< the last of `done` goes on changing: it is a drag
};

/// One step more. What was undone is forgotten.
void do_edit(const Edit& edit, History& history);
/// A drag is one step: the first call makes it, and each that follows and is of the same thing
/// takes its place, until end_drag().
void drag_edit(const Edit& edit, History& history);
void end_drag(History& history);
/// Takes the last step back, or does it again; a drag ends before. False where there is none.
bool undo(History& history);
bool redo(History& history);

using EditedLamp = Lamp;
/// Properties of a material that can be changed.
struct MaterialLook {
  Rgb base_color{1, 1, 1}, emission{};
  float metallic = 0;
  friend bool operator==(const MaterialLook&, const MaterialLook&) = default;
};

MaterialLook look_of(const scene::Material& material);

/// All that edits can change, as it is now.
struct SceneNow {
  std::vector<Mat34> world_from_object;  ///< of each instance
  std::vector<EditedLamp> lamps;         ///< of the scene as it was read, then those added
  std::vector<MaterialLook> materials;
  std::optional<SkyAsked> sky;  ///< another one than was read
};

/// As it was read.
SceneNow unedited(const scene::Scene& as_read);
/// After all that was done.
SceneNow now_after(const scene::Scene& as_read, const History& history);
void put(const Edit& edit, SceneNow& now);

/// The scene as it is now. Each lamp keeps its number: those that are off or deleted have the
/// intensity 0. Takes as long as copying the scene.
scene::Scene edited(const scene::Scene& as_read, const SceneNow& now);

/// True where an edit names things that exist, and holds only numbers that a scene may hold.
bool can_be_put(const Edit& edit, const SceneNow& now);

/// A scene while it is edited.
struct EditDesk {
  std::shared_ptr<const ReadScene> read;  ///< the scene as it was read
  History history;
  SceneNow now;
  uint64_t changes = 0;  ///< grows whenever `now` changes
};

EditDesk begin_editing(std::shared_ptr<const ReadScene> read);

/// do_edit() and so on, and `now` follows. What cannot be put changes nothing.
void do_edit(const Edit& edit, EditDesk& desk);
void drag_edit(const Edit& edit, EditDesk& desk);
void end_drag(EditDesk& desk);
bool undo(EditDesk& desk);
bool redo(EditDesk& desk);

}  // namespace luxel::view
