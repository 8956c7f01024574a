#include "luxel/view/relight/lamp_desk.h"

#include <algorithm>
#include <cmath>

#include "luxel/view/model/lamp_change.h"

namespace luxel::view {
namespace {

MarkedLamps marked(const LampDesk& desk) {
  return {desk.lamps.lamps, desk.bounds, desk.selected, desk.axis};
}

void drag_held(Vec2 pointer, const Walk& walk, LampDesk& desk) {
  const Vec3 to = dragged(desk.held_from, pointer - desk.pointer_from, desk.axis, walk);
  put_at(*desk.held, to, desk.bounds, desk.lamps.lamps[desk.held->lamp].light);
  ++desk.changes;
}

bool press(const Walk& walk, LampDesk& desk) {
  if (walk.dragging || !desk.has_marks) return false;
  desk.held = handle_at(marked(desk), walk, walk.pointer);
  if (!desk.held) return false;
  desk.selected = desk.held->lamp;
  desk.held_from = place_of(*desk.held, desk), desk.pointer_from = walk.pointer;
  return true;
}

void press_key(const std::string& key, LampDesk& desk) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis)
    if (key == kAxes[axis]) desk.axis = desk.axis == axis ? std::nullopt : std::optional<int>(axis);
  if (key == "m") desk.has_marks = !desk.has_marks;
}

void set_glow_of(const GlowChanged& changed, LampDesk& desk) {
  for (Glow& glow : desk.lamps.glows)
    if (glow.name == changed.material) glow.radiance = changed.radiance, glow.is_on = true;
  ++desk.changes;
}

}  // namespace

LampDesk begin_desk(const Lamps& lamps, const Box3& bounds, DVec3 origin) {
  LampDesk out;
  out.lamps = lamps, out.bounds = bounds, out.origin = origin;
  return out;
}

Vec3 place_of(const Handle& handle, const LampDesk& desk) {
  return place_of(handle, desk.lamps.lamps[handle.lamp].light, desk.bounds);
}

bool handle_lamps(const Event& event, const Walk& walk, LampDesk& desk) {
  if (const auto* moved = std::get_if<PointerMoved>(&event); moved && desk.held)
    drag_held(moved->to, walk, desk);
  if (const auto* button = std::get_if<ButtonChanged>(&event)) {
    if (button->button != Button::left) return false;
    if (button->is_down) return press(walk, desk);
    return std::exchange(desk.held, std::nullopt).has_value();
  }
  if (const auto* key = std::get_if<KeyChanged>(&event); key && key->is_down)
    press_key(key->key, desk);
  if (const auto* changed = std::get_if<LampChanged>(&event)) change_lamp(*changed, desk);
  if (const auto* added = std::get_if<LampAdded>(&event)) add_lamp(*added, desk);
  if (const auto* changed = std::get_if<GlowChanged>(&event)) set_glow_of(*changed, desk);
  return false;
}

void change_lamp(const LampChanged& changed, LampDesk& desk) {
  if (changed.lamp >= desk.lamps.lamps.size()) return;
  change(changed.change, desk.origin, desk.lamps.lamps[changed.lamp]);
  ++desk.changes;
}

void add_lamp(const LampAdded& added, LampDesk& desk) {
  desk.lamps.lamps.push_back(new_lamp(added, desk.bounds, desk.origin));
  desk.selected = uint32_t(desk.lamps.lamps.size() - 1);
  ++desk.changes;
}

std::vector<Mark> marks_of(const LampDesk& desk, const Walk& walk) {
  return desk.has_marks ? marks_of(marked(desk), walk) : std::vector<Mark>();
}

Status check_lamp_event(const Event& event, const Lamps& lamps) {
  if (edits_scene(event))
    return fail(ErrorCode::bad_input,
                "in an .lxr file only lamps and emissive materials change; open the scene itself "
                "to change more");
  if (const auto* changed = std::get_if<LampChanged>(&event);
      changed && changed->lamp >= lamps.lamps.size())
    return fail(ErrorCode::bad_input, "there is no lamp {}; there are {}", changed->lamp,
                lamps.lamps.size());
  const auto* changed = std::get_if<GlowChanged>(&event);
  if (!changed) return {};
  const auto is_it = [&](const Glow& glow) { return glow.name == changed->material; };
  if (std::ranges::any_of(lamps.glows, is_it)) return {};
  return fail(ErrorCode::bad_input, "the scene has no material '{}'", changed->material);
}

Status check_lamps(const Play& play, const Lamps& lamps, const std::string& name) {
  Lamps there = lamps;
  for (const TimedEvent& timed : play.events) {
    if (std::holds_alternative<LampAdded>(timed.event)) there.lamps.emplace_back();
    if (const Status fits = check_lamp_event(timed.event, there); !fits)
      return fail(ErrorCode::bad_input, "{}, at {} s: {}", name, timed.at_s, fits.error().message);
  }
  return {};
}

Status check_no_lamps(const Play& play, const std::string& name) {
  for (const TimedEvent& timed : play.events)
    if (changes_lamps(timed.event) || edits_scene(timed.event))
      return fail(ErrorCode::bad_input,
                  "{}, at {} s: this is for scenes that are baked while you look, or for lamps of "
                  ".lxr files; a finished bake cannot be changed",
                  name, timed.at_s);
  return {};
}

}  // namespace luxel::view
