// Taking hold of a scene: events in, edits, what is selected and its marks out.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "luxel/view/edit/edits.h"
#include "luxel/view/edit/gizmo.h"
#include "luxel/view/edit/placement.h"
#include "luxel/view/model/lamp_marks.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

/// The selection: a lamp, or surfaces and perhaps one of their materials, or nothing.
struct EditSelection {
  std::optional<uint32_t> instance{}, material{}, lamp{};
  friend bool operator==(const EditSelection&, const EditSelection&) = default;
};

/// A grip of a gizmo while it is held.
struct HeldGrip {
  Gizmo gizmo;  ///< as it stood when it was taken
  Grip grip = Grip::all;
};

/// A scene that is edited, and what the user is doing with it.
struct EditTools {
  EditDesk desk;
  Box3 bounds;  ///< of the scene as it was read [m]
  Tool tool = Tool::move;
  EditSelection selected;
  Vec3 middle;            ///< of the selected instance's mesh, before it is placed [m]
  bool has_marks = true;  ///< lamps are marked
  std::string message;    ///< what of an event could not be done; whoever tells it takes it out

  // A drag: what is held, as it was, and where the pointer was.
  std::optional<HeldGrip> held;
  std::optional<Handle> held_mark;
  Mat34 placed_from;
  Lamp lamp_from;
  Vec2 pointer_from{};
  bool may_be_click = false;  ///< the button is down, and the pointer has hardly moved
};

EditTools begin_tools(std::shared_ptr<const ReadScene> read);

/// Acts on an event. True: it is no longer the walk's. A press and release on a surface selects its
/// instance, and one more its material; beside all surfaces it deselects. Grips and marks of lamps
/// are dragged; with ctrl in steps.
bool handle_edits(const Event& event, const Walk& walk, EditTools& tools);

void select(const EditSelection& selection, EditTools& tools);
/// Where the selected instance stands. Only where one is selected.
Placement placement_of(const EditTools& tools);
/// The box around it where it is now; a lamp's is a tenth of the scene's. Empty: nothing is
/// selected, or a sun.
Box3 selected_box(const EditTools& tools);
/// Takes a step back or does it again; what is no more is no longer selected.
void undo_step(EditTools& tools);
void redo_step(EditTools& tools);
/// A lamp more, which is selected.
void add_lamp(const LampAdded& added, EditTools& tools);
void delete_lamp(uint32_t lamp, EditTools& tools);

/// The gizmo of what is selected; none where nothing is.
std::optional<Gizmo> gizmo_of(const EditTools& tools);
/// Marks of lamps and the gizmo as they are seen.
std::vector<Mark> marks_of(const EditTools& tools, const Walk& walk);

}  // namespace luxel::view
