#include "luxel/view/model/lamp_marks.h"

#include <cmath>

#include "luxel/scene/light_kinds.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

constexpr float kSunAway = 0.35f;    ///< of the scene's diagonal: its handle, from the middle
constexpr float kTurnAway = 0.12f;   ///< and that of a spot's direction, from the spot
constexpr float kPointerReach = 14;  ///< of the pointer [pixels]
constexpr Rgb kYellow{1, 0.85f, 0.2f};

/// All handles; those of spots' directions only where the spot is selected.
std::vector<Handle> handles_of(const MarkedLamps& marked) {
  std::vector<Handle> out;
  for (uint32_t i = 0; i < marked.lamps.size(); ++i) {
    if (marked.lamps[i].is_deleted) continue;
    out.push_back({i, false});
    if (marked.selected == i && scene::has_cone(marked.lamps[i].light.kind))
      out.push_back({i, true});
  }
  return out;
}

Vec3 place_of_handle(const Handle& handle, const MarkedLamps& marked) {
  return place_of(handle, marked.lamps[handle.lamp].light, marked.bounds);
}

/// A lamp's colour at full brightness.
Rgb shown_color(const Lamp& lamp) {
  const float most = max_component(lamp.light.intensity);
  if (!lamp.is_on || !(most > 0)) return {0.25f, 0.25f, 0.25f};
  const Rgb c = lamp.light.intensity / most;
  return {std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)};
}

void add_line(Vec3 from, Vec3 to, Rgb color, const Walk& walk, std::vector<Mark>& out) {
  const auto a = pixel_of(walk, from), b = pixel_of(walk, to);
  if (a && b) out.push_back({*a, *b, 0.8f, color, {0, 0, 0}, 0.6f});
}

void add_marks(const Handle& handle, const MarkedLamps& marked, const Walk& walk,
               std::vector<Mark>& out) {
  const Lamp& lamp = marked.lamps[handle.lamp];
  const bool is_selected = marked.selected == handle.lamp;
  const Vec3 place = place_of_handle(handle, marked);
  if (handle.turns) add_line(lamp.light.position, place, kYellow, walk, out);
  if (!scene::has_position(lamp.light.kind))
    add_line(place, marked.bounds.centre(), kYellow, walk, out);
  if (is_selected && marked.axis && !handle.turns) {
    const Vec3 axis = axis_of(*marked.axis), along = axis * (0.1f * marked.bounds.diagonal());
    add_line(place - along, place + along, axis * 0.7f + Rgb{0.3f, 0.3f, 0.3f}, walk, out);
  }
  if (const auto at = pixel_of(walk, place))
    out.push_back({*at, *at, handle.turns ? 4.0f : 6.0f, shown_color(lamp),
                   is_selected ? kYellow : Rgb{0.1f, 0.1f, 0.1f}, is_selected ? 2.5f : 1.5f});
}

}  // namespace

Vec3 place_of(const Handle& handle, const scene::PunctualLight& light, const Box3& bounds) {
  const float diagonal_m = bounds.diagonal();
  if (!scene::has_position(light.kind))
    return bounds.centre() - light.direction * (kSunAway * diagonal_m);
  if (!handle.turns) return light.position;
  return light.position + light.direction * (kTurnAway * diagonal_m);
}

void put_at(const Handle& handle, Vec3 place, const Box3& bounds, scene::PunctualLight& light) {
  const bool is_sun = !scene::has_position(light.kind);
  const Vec3 to = is_sun ? bounds.centre() - place : place - light.position;
  if (!is_sun && !handle.turns) light.position = place;
  if ((is_sun || handle.turns) && length(to) > 0) light.direction = normalize(to);
}

Vec3 dragged(Vec3 from, Vec2 by, std::optional<int> axis, const Walk& walk) {
  // The handle may have been taken beside its middle.
  const auto middle = pixel_of(walk, from);
  if (!middle) return from;
  const trace::Ray ray = ray_through(walk, *middle + by);
  return axis ? on_line(ray, from, axis_of(*axis)) : on_plane(ray, from, forward_of(walk));
}

std::optional<Handle> handle_at(const MarkedLamps& marked, const Walk& walk, Vec2 pixel) {
  std::optional<Handle> nearest;
  float least = kPointerReach;
  for (const Handle& handle : handles_of(marked)) {
    const auto at = pixel_of(walk, place_of_handle(handle, marked));
    if (!at || length(*at - pixel) > least) continue;
    least = length(*at - pixel), nearest = handle;
  }
  return nearest;
}

std::vector<Mark> marks_of(const MarkedLamps& marked, const Walk& walk) {
  std::vector<Mark> out;
  for (const Handle& handle : handles_of(marked)) add_marks(handle, marked, walk, out);
  return out;
}

}  // namespace luxel::view
