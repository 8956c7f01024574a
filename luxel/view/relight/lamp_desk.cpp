#include "luxel/view/relight/lamp_desk.h"

#include <algorithm>
#include <cmath>

#include "luxel/scene/light_kinds.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::view {
namespace {

constexpr float kSunAway = 0.35f;   ///< of the scene's diagonal: its handle, from the middle
constexpr float kTurnAway = 0.12f;  ///< and that of a spot's direction, from the spot
constexpr float kReach = 14;        ///< of the pointer [pixels]
constexpr float kSmallestAngle = 1e-4f;

const scene::PunctualLight& light_of(const Handle& handle, const LampDesk& desk) {
  return desk.lamps.lamps[handle.lamp].light;
}

/// All handles; those of spots' directions only where the spot is selected.
std::vector<Handle> handles_of(const LampDesk& desk) {
  std::vector<Handle> out;
  for (uint32_t i = 0; i < desk.lamps.lamps.size(); ++i) {
    out.push_back({i, false});
    if (desk.selected == i && scene::has_cone(desk.lamps.lamps[i].light.kind))
      out.push_back({i, true});
  }
  return out;
}

void put_at(const Handle& handle, Vec3 place, LampDesk& desk) {
  scene::PunctualLight& light = desk.lamps.lamps[handle.lamp].light;
  const bool is_sun = !scene::has_position(light.kind);
  const Vec3 to = is_sun ? desk.bounds.centre() - place : place - light.position;
  if (!is_sun && !handle.turns) light.position = place;
  if ((is_sun || handle.turns) && length(to) > 0) light.direction = normalize(to);
  ++desk.changes;
}

/// The nearest handle within reach of a pixel.
std::optional<Handle> handle_at(const LampDesk& desk, const Walk& walk, Vec2 pixel) {
  std::optional<Handle> nearest;
  float least = kReach;
  for (const Handle& handle : handles_of(desk)) {
    const auto at = pixel_of(walk, place_of(handle, desk));
    if (!at || length(*at - pixel) > least) continue;
    least = length(*at - pixel), nearest = handle;
  }
  return nearest;
}

/// How far along `ray` the plane through `place` that faces the camera is.
Vec3 on_plane(const trace::Ray& ray, Vec3 place, Vec3 forward) {
  return ray.origin +
         ray.direction * (dot(place - ray.origin, forward) / dot(ray.direction, forward));
}

/// The place of a line that comes nearest to a ray; the line's own where they are parallel.
Vec3 on_line(const trace::Ray& ray, Vec3 place, Vec3 axis) {
  const Vec3 d = ray.direction, w = place - ray.origin;
  const float b = dot(axis, d), square = 1 - b * b;  // of the sine between them
  if (square < kSmallestAngle) return place;
  return place + axis * ((b * dot(d, w) - dot(axis, w)) / square);
}

void drag_held(Vec2 pointer, const Walk& walk, LampDesk& desk) {
  const trace::CameraRays rays(walk.shown.camera, walk.width, walk.height);
  // The handle may have been taken beside its middle.
  const auto middle = pixel_of(walk, desk.held_from);
  if (!middle) return;
  const Vec2 at = *middle + pointer - desk.pointer_from;
  const trace::Ray ray = rays.through(at.x, at.y);
  if (!desk.axis) {
    put_at(*desk.held, on_plane(ray, desk.held_from, rays.forward), desk);
    return;
  }
  const Vec3 axis{float(*desk.axis == 0), float(*desk.axis == 1), float(*desk.axis == 2)};
  put_at(*desk.held, on_line(ray, desk.held_from, axis), desk);
}

bool press(const Walk& walk, LampDesk& desk) {
  if (walk.dragging || !desk.has_marks) return false;
  desk.held = handle_at(desk, walk, walk.pointer);
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

/// A lamp's colour at full brightness.
Rgb shown_color(const Lamp& lamp) {
  const float most = max_component(lamp.light.intensity);
  if (!lamp.is_on || !(most > 0)) return {0.25f, 0.25f, 0.25f};
  const Rgb c = lamp.light.intensity / most;
  return {std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)};
}

}  // namespace

LampDesk begin_desk(const Lamps& lamps, const Box3& bounds) {
  LampDesk out;
  out.lamps = lamps, out.bounds = bounds;
  return out;
}

Vec3 place_of(const Handle& handle, const LampDesk& desk) {
  const scene::PunctualLight& light = light_of(handle, desk);
  const float diagonal_m = desk.bounds.diagonal();
  if (!scene::has_position(light.kind))
    return desk.bounds.centre() - light.direction * (kSunAway * diagonal_m);
  if (!handle.turns) return light.position;
  return light.position + light.direction * (kTurnAway * diagonal_m);
}

std::optional<Vec2> pixel_of(const Walk& walk, Vec3 place) {
  const trace::CameraRays rays(walk.shown.camera, walk.width, walk.height);
  const Vec3 to = place - rays.eye;
  const float ahead = dot(to, rays.forward);
  if (!(ahead > 0)) return std::nullopt;
  const float scale = rays.orthographic ? 1 : ahead;
  const float x = dot(to, rays.right) / (dot(rays.right, rays.right) * scale);
  const float y = dot(to, rays.up) / (dot(rays.up, rays.up) * scale);
  return Vec2{0.5f * float(walk.width) * (1 + x), 0.5f * float(walk.height) * (1 - y)};
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
  Lamp& lamp = desk.lamps.lamps[changed.lamp];
  const LampChange& to = changed.change;
  if (to.to) lamp.light.position = *to.to;
  if (to.direction) lamp.light.direction = normalize(*to.direction);
  if (to.intensity) lamp.light.intensity = *to.intensity;
  if (to.is_on) lamp.is_on = *to.is_on;
  ++desk.changes;
}

void add_lamp(const LampAdded& added, LampDesk& desk) {
  Lamp lamp;
  lamp.light.kind = added.kind, lamp.light.position = desk.bounds.centre();
  lamp.light.name = "new " + std::string(scene::name_of(added.kind));
  desk.lamps.lamps.push_back(lamp);
  desk.selected = uint32_t(desk.lamps.lamps.size() - 1);
  change_lamp({*desk.selected, added.change}, desk);
}

std::vector<Mark> marks_of(const LampDesk& desk, const Walk& walk) {
  std::vector<Mark> out;
  if (!desk.has_marks) return out;
  const auto add_line = [&](Vec3 from, Vec3 to, Rgb color) {
    const auto a = pixel_of(walk, from), b = pixel_of(walk, to);
    if (a && b) out.push_back({*a, *b, 0.8f, color, {0, 0, 0}, 0.6f});
  };
  for (const Handle& handle : handles_of(desk)) {
    const Lamp& lamp = desk.lamps.lamps[handle.lamp];
    const bool is_selected = desk.selected == handle.lamp;
    const Vec3 place = place_of(handle, desk);
    const Rgb yellow{1, 0.85f, 0.2f};
    if (handle.turns) add_line(lamp.light.position, place, yellow);
    if (!scene::has_position(lamp.light.kind)) add_line(place, desk.bounds.centre(), yellow);
    if (is_selected && desk.axis && !handle.turns) {
      const Vec3 axis{float(*desk.axis == 0), float(*desk.axis == 1), float(*desk.axis == 2)};
      const Vec3 along = axis * (0.1f * desk.bounds.diagonal());
      add_line(place - along, place + along, axis * 0.7f + Rgb{0.3f, 0.3f, 0.3f});
    }
    if (const auto at = pixel_of(walk, place))
      out.push_back({*at, *at, handle.turns ? 4.0f : 6.0f, shown_color(lamp),
                     is_selected ? yellow : Rgb{0.1f, 0.1f, 0.1f}, is_selected ? 2.5f : 1.5f});
  }
  return out;
}

Status check_lamps(const Play& play, const Lamps& lamps, const std::string& name) {
  size_t count = lamps.lamps.size();
  for (const TimedEvent& timed : play.events) {
    if (std::holds_alternative<LampAdded>(timed.event)) ++count;
    if (const auto* changed = std::get_if<LampChanged>(&timed.event);
        changed && changed->lamp >= count)
      return fail(ErrorCode::bad_input, "{}, at {} s: there is no lamp {}; there are {}", name,
                  timed.at_s, changed->lamp, count);
    const auto* changed = std::get_if<GlowChanged>(&timed.event);
    if (!changed) continue;
    const auto is_it = [&](const Glow& glow) { return glow.name == changed->material; };
    if (std::none_of(lamps.glows.begin(), lamps.glows.end(), is_it))
      return fail(ErrorCode::bad_input, "{}, at {} s: the scene has no material '{}'", name,
                  timed.at_s, changed->material);
  }
  return {};
}

Status check_no_lamps(const Play& play, const std::string& name) {
  for (const TimedEvent& timed : play.events)
    if (std::holds_alternative<LampChanged>(timed.event) ||
        std::holds_alternative<LampAdded>(timed.event) ||
        std::holds_alternative<GlowChanged>(timed.event))
      return fail(ErrorCode::bad_input,
                  "{}, at {} s: lamps change in .lxr files only; `luxel relight` makes one", name,
                  timed.at_s);
  return {};
}

}  // namespace luxel::view
