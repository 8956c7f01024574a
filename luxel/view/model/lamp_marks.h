// Marks of lamps over the picture, by which they are taken.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "luxel/view/lamp.h"
#include "luxel/view/mark.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

/// The part of a lamp that can be taken hold of.
struct Handle {
  uint32_t lamp = 0;
  bool turns = false;  ///< a spot's direction; otherwise the lamp itself, or the sun in its sky
  friend bool operator==(const Handle&, const Handle&) = default;
};

/// Lamps as they are marked. Of spots that are selected the direction can be taken, too.
struct MarkedLamps {
  std::span<const Lamp> lamps;
  const Box3& bounds;  ///< of the scene [m]
  std::optional<uint32_t> selected;
  std::optional<int> axis;  ///< 0 to 2: the selected lamp moves along x, y, z alone
};

/// Where a handle of a lamp is [m].
Vec3 place_of(const Handle& handle, const scene::PunctualLight& light, const Box3& bounds);
/// The lamp with its handle at this place. A sun turns around the scene.
void put_at(const Handle& handle, Vec3 place, const Box3& bounds, scene::PunctualLight& light);
/// Where a handle that was at `from` is when the pointer has moved by so many pixels: in the plane
/// that faces the camera, or along an axis.
Vec3 dragged(Vec3 from, Vec2 by, std::optional<int> axis, const Walk& walk);

/// The nearest handle within reach of a pixel.
std::optional<Handle> handle_at(const MarkedLamps& marked, const Walk& walk, Vec2 pixel);
/// The marks as they are seen.
std::vector<Mark> marks_of(const MarkedLamps& marked, const Walk& walk);

/// The unit vector along x, y or z.
inline Vec3 axis_of(int axis) { return {float(axis == 0), float(axis == 1), float(axis == 2)}; }

}  // namespace luxel::view
