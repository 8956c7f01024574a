#include "luxel/view/edit/gizmo.h"

#include <algorithm>
#include <cmath>

#include "luxel/trace/camera_rays.h"
#include "luxel/view/edit/gizmo_shape.h"
#include "luxel/view/edit/placement.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

constexpr float kLeastFactor = 0.01f;
constexpr float kPixelsPerOctave = 100;  ///< of a drag that scales along all axes

float snapped(float value, float step) {
  return step > 0 ? std::round(value / step) * step : value;
}

Vec3 snapped(Vec3 v, float step) {
  return {snapped(v.x, step), snapped(v.y, step), snapped(v.z, step)};
}

/// Place of the pointer along an axis, from the gizmo's centre [m].
float along_axis(const Gizmo& gizmo, Vec3 axis, Vec2 pixel, const Walk& walk) {
  return dot(on_line(ray_through(walk, pixel), gizmo.centre, axis) - gizmo.centre, axis);
}

Vec3 move_by(const Gizmo& gizmo, Grip grip, Vec2 from, Vec2 to, const Snap& snap,
             const Walk& walk) {
  if (grip <= Grip::z) {
    const Vec3 axis = column(gizmo.axes, int(grip));
    const float by = along_axis(gizmo, axis, to, walk) - along_axis(gizmo, axis, from, walk);
    return axis * snapped(by, snap.move_m);
  }
  const Vec3 normal =
      grip == Grip::all ? forward_of(walk) : column(gizmo.axes, int(grip) - int(Grip::yz));
  const auto at = [&](Vec2 pixel) {
    return on_plane(ray_through(walk, pixel), gizmo.centre, normal);
  };
  return snapped(at(to) - at(from), snap.move_m);
}

/// The angle about an axis at which a pixel sees the ring's plane.
float angle_at(const Gizmo& gizmo, int axis, Vec2 pixel, const Walk& walk) {
  const Vec3 by =
      on_plane(ray_through(walk, pixel), gizmo.centre, column(gizmo.axes, axis)) - gizmo.centre;
  return std::atan2(dot(by, column(gizmo.axes, (axis + 2) % 3)),
                    dot(by, column(gizmo.axes, (axis + 1) % 3)));
}

/// A ring that is seen from its edge turns as the pointer goes along it.
float angle_along_edge(const Gizmo& gizmo, int axis, Vec2 from, Vec2 to, const Walk& walk) {
  constexpr float kStep_rad = 0.01f;
  const std::vector<Vec3> ring = ring_of(gizmo, axis, walk);
  float least = INFINITY;
  Vec2 along{};
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec3 end =
        transform_point(turned_about(gizmo.centre, column(gizmo.axes, axis), kStep_rad), ring[i]);
    const auto a = pixel_of(walk, ring[i]), b = pixel_of(walk, end);
    if (!a || !b || length(*a - from) >= least || is_behind(gizmo, ring[i], walk)) continue;
    least = length(*a - from), along = (*b - *a) * (1 / kStep_rad);
  }
  return dot(along, along) > 0 ? dot(to - from, along) / dot(along, along) : 0;
}

float turn_by(const Gizmo& gizmo, int axis, Vec2 from, Vec2 to, const Walk& walk) {
  constexpr float kEdge = 0.2f;  ///< cosine
  const Vec3 view = towards(gizmo, walk);
  if (std::abs(dot(view, column(gizmo.axes, axis))) < kEdge)
    return angle_along_edge(gizmo, axis, from, to, walk);
  return angle_at(gizmo, axis, to, walk) - angle_at(gizmo, axis, from, walk);
}

Vec3 scale_by(const Gizmo& gizmo, Grip grip, Vec2 from, Vec2 to, const Snap& snap,
              const Walk& walk) {
  const auto factor = [&](float f) {
    return std::max(snapped(f, snap.scale), std::max(snap.scale, kLeastFactor));
  };
  if (grip > Grip::z) {
    const float f = factor(std::exp2((to.x - from.x - (to.y - from.y)) / kPixelsPerOctave));
    return {f, f, f};
  }
  const Vec3 axis = column(gizmo.axes, int(grip));
  const float was = along_axis(gizmo, axis, from, walk);
  const float f = was == 0 ? 1 : factor(along_axis(gizmo, axis, to, walk) / was);
  return {grip == Grip::x ? f : 1, grip == Grip::y ? f : 1, grip == Grip::z ? f : 1};
}

}  // namespace

Snap snap_of(const Box3& bounds) {
  constexpr float kStepsPerScene = 100;
  const float wanted = std::max(bounds.diagonal(), 1e-6f) / kStepsPerScene;
  const float decade = std::pow(10.0f, std::floor(std::log10(wanted)));
  const float part = wanted / decade;
  return {decade * (part < 2 ? 1.0f : part < 5 ? 2.0f : 5.0f), kPi / 12, 0.1f};
}

Mat34 dragged_by(const Gizmo& gizmo, Grip grip, Vec2 from, Vec2 to, const Snap& snap,
                 const Walk& walk) {
  if (gizmo.tool == Tool::move) return translation(move_by(gizmo, grip, from, to, snap, walk));
  if (gizmo.tool == Tool::scale)
    return scaled_about(gizmo.centre, gizmo.axes, scale_by(gizmo, grip, from, to, snap, walk));
  const int axis = std::min(int(grip), 2);
  const float angle = snapped(turn_by(gizmo, axis, from, to, walk), snap.turn_rad);
  return turned_about(gizmo.centre, column(gizmo.axes, axis), angle);
}

}  // namespace luxel::view
