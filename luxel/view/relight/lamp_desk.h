// Taking hold of lamps: events in, lamps and their marks out.
#pragma once

#include <optional>
#include <vector>

#include "luxel/view/model/lamp_marks.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/relight/lamps.h"

namespace luxel::view {

/// The lamps, and what the user is doing with them.
struct LampDesk {
  Lamps lamps;
  Box3 bounds;     ///< of the scene [m]
  DVec3 origin{};  ///< scene::Scene::origin
  std::optional<uint32_t> selected;
  std::optional<int> axis;  ///< 0 to 2: lamps move along x, y, z alone
  bool has_marks = true;    ///< lamps are marked
  uint64_t changes = 0;     ///< of light

  std::optional<Handle> held;
  Vec3 held_from{};     ///< where the handle was when it was taken
  Vec2 pointer_from{};  ///< and the pointer
};

LampDesk begin_desk(const Lamps& lamps, const Box3& bounds, DVec3 origin = {});

/// Where a handle is [m].
Vec3 place_of(const Handle& handle, const LampDesk& desk);

/// Changes lamps by an event. True: it is no longer the walk's. A press of the left button near a
/// mark takes the lamp; while it is held it follows the pointer in the plane that faces the camera,
/// or along one axis. A sun turns around the scene.
bool handle_lamps(const Event& event, const Walk& walk, LampDesk& desk);

/// The lamp `changed` becomes otherwise. A number that there is not changes nothing.
void change_lamp(const LampChanged& changed, LampDesk& desk);
/// A lamp more, which is selected; without a place of its own it is in the scene's middle.
void add_lamp(const LampAdded& added, LampDesk& desk);

/// The marks of all lamps as they are seen.
std::vector<Mark> marks_of(const LampDesk& desk, const Walk& walk);

/// Errors: an event of a lamp or a material that there is not, or of something else of a scene.
Status check_lamp_event(const Event& event, const Lamps& lamps);
/// Errors: those of its events; `name` is the play's.
Status check_lamps(const Play& play, const Lamps& lamps, const std::string& name);

/// Errors: an event that changes a scene, for what stays as it is.
Status check_no_lamps(const Play& play, const std::string& name);

}  // namespace luxel::view
