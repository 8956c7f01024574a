#include "luxel/view/edit/gizmo_shape.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "luxel/trace/camera_rays.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

constexpr int kRingSteps = 72;
constexpr float kGripReach = 8;   ///< of the pointer [pixels]
constexpr float kAlmost = 0.97f;  ///< cosine: an axis that points at the eye
constexpr float kEdgeOn = 0.15f;  ///< cosine: a plane that is seen from its edge
constexpr float kPlaneFrom = 0.28f, kPlaneTo = 0.46f;  ///< of its square, over the reach
constexpr Rgb kAxisColors[] = {{0.93f, 0.22f, 0.27f}, {0.42f, 0.78f, 0.16f}, {0.2f, 0.5f, 1}};
constexpr Rgb kLit{1, 0.86f, 0.25f}, kMiddle{0.93f, 0.93f, 0.93f};

/// A stroke of a gizmo.
struct Stroke {
  Vec2 from, to;
  float radius;
  Rgb color;
};

/// A gizmo in the picture.
struct Seen {
  const Gizmo& gizmo;
  const Walk& walk;
  float reach_m;
  Vec3 view;

  Vec3 place(int axis, float part) const {
    return gizmo.centre + column(gizmo.axes, axis) * (part * reach_m);
  }
  Vec3 place(int axis, float part, int other, float part_of_other) const {
    return place(axis, part) + column(gizmo.axes, other) * (part_of_other * reach_m);
  }
  std::optional<Vec2> pixel(Vec3 place) const { return pixel_of(walk, place); }
  bool has_axis(int axis) const { return std::abs(dot(view, column(gizmo.axes, axis))) < kAlmost; }
  bool has_plane(int axis) const {
    return gizmo.tool == Tool::move && std::abs(dot(view, column(gizmo.axes, axis))) > kEdgeOn;
  }
};

Seen seen(const Gizmo& gizmo, const Walk& walk) {
  return {gizmo, walk, gizmo_reach(walk) * metres_per_pixel(walk, gizmo.centre),
          towards(gizmo, walk)};
}

/// The corners of a plane's square; empty behind the eye.
std::vector<Vec2> square_of(const Seen& seen, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Vec2> out;
  for (const auto& [a, b] : {std::pair(kPlaneFrom, kPlaneFrom), std::pair(kPlaneTo, kPlaneFrom),
                             std::pair(kPlaneTo, kPlaneTo), std::pair(kPlaneFrom, kPlaneTo)})
    if (const auto at = seen.pixel(seen.place(u, a, v, b))) out.push_back(*at);
  return out.size() == 4 ? out : std::vector<Vec2>();
}

float distance_to(Vec2 p, Vec2 from, Vec2 to) {
  const Vec2 along = to - from;
  const float square = dot(along, along);
  const float part = square > 0 ? std::clamp(dot(p - from, along) / square, 0.0f, 1.0f) : 0;
  return length(p - from - along * part);
}

bool is_inside(Vec2 p, std::span<const Vec2> corners) {
  bool left = true, right = true;
  for (size_t i = 0; i < corners.size(); ++i) {
    const float side = cross(corners[(i + 1) % corners.size()] - corners[i], p - corners[i]);
    left &= side >= 0, right &= side <= 0;
  }
  return left || right;
}

/// Fills what lies between two edges by strokes along them.
void fill(Vec2 a, Vec2 b, Vec2 c, Vec2 d, Rgb color, std::vector<Stroke>& out) {
  const float width = std::max(length(c - a), length(d - b));
  const int steps = std::max(1, int(std::ceil(width / 1.5f)));
  for (int i = 0; i <= steps; ++i) {
    const float part = float(i) / float(steps);
    out.push_back({a + (c - a) * part, b + (d - b) * part, 1, color});
  }
}

void add_arrow(Vec2 from, Vec2 to, Rgb color, std::vector<Stroke>& out) {
  constexpr float kHead = 13, kHalfWidth = 5;
  const Vec2 way = length(to - from) > 0 ? (to - from) * (1 / length(to - from)) : Vec2{1, 0};
  const Vec2 aside{-way.y * kHalfWidth, way.x * kHalfWidth}, base = to - way * kHead;
  out.push_back({from, base, 1.3f, color});
  fill(base + aside, to, base - aside, to, color, out);
}

void add_axes(const Seen& s, std::optional<Grip> lit, std::vector<Stroke>& out) {
  const auto middle = s.pixel(s.gizmo.centre);
  for (int axis = 0; axis < 3; ++axis) {
    const auto end = s.pixel(s.place(axis, 1)), begin = s.pixel(s.place(axis, 0.12f));
    if (!middle || !end || !begin || !s.has_axis(axis)) continue;
    const Rgb color = lit == Grip(axis) ? kLit : kAxisColors[axis];
    if (s.gizmo.tool == Tool::move) {
      add_arrow(*begin, *end, color, out);
      continue;
    }
    constexpr float kBox = 4.5f;
    out.push_back({*begin, *end, 1.3f, color});
    fill(*end + Vec2{-kBox, -kBox}, *end + Vec2{kBox, -kBox}, *end + Vec2{-kBox, kBox},
         *end + Vec2{kBox, kBox}, color, out);
  }
  const Rgb color = lit == Grip::all ? kLit : kMiddle;
  if (middle) out.push_back({*middle, *middle, 5, color});
}

void add_squares(const Seen& s, std::optional<Grip> lit, std::vector<Stroke>& out) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!s.has_plane(axis)) continue;
    const std::vector<Vec2> at = square_of(s, axis);
    const Grip grip = Grip(int(Grip::yz) + axis);
    if (!at.empty())
      fill(at[0], at[1], at[3], at[2], lit == grip ? kLit : kAxisColors[axis] * 0.85f, out);
  }
}

/// The far sides first.
void add_rings(const Seen& s, std::optional<Grip> lit, std::vector<Stroke>& out) {
  for (const bool far : {true, false})
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<Vec3> ring = ring_of(s.gizmo, axis, s.walk);
      const Rgb color = lit == Grip(axis) ? kLit : kAxisColors[axis];
      for (size_t i = 0; i < ring.size(); ++i) {
        const Vec3 next = ring[(i + 1) % ring.size()];
        const auto a = s.pixel(ring[i]), b = s.pixel(next);
        if (a && b && far == is_behind(s.gizmo, (ring[i] + next) * 0.5f, s.walk))
          out.push_back({*a, *b, far ? 0.8f : 1.5f, far ? color * 0.5f : color});
      }
    }
}

/// Keeps what is nearer than before.
struct Nearest {
  std::optional<Grip> grip;
  float least = kGripReach;
  void offer(Grip offered, float distance) {
    if (distance < least) grip = offered, least = distance;
  }
};

std::optional<Grip> ring_at(const Seen& s, Vec2 pixel) {
  Nearest nearest;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Vec3> ring = ring_of(s.gizmo, axis, s.walk);
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec3 next = ring[(i + 1) % ring.size()];
      const auto a = s.pixel(ring[i]), b = s.pixel(next);
      if (a && b && !is_behind(s.gizmo, (ring[i] + next) * 0.5f, s.walk))
        nearest.offer(Grip(axis), distance_to(pixel, *a, *b));
    }
  }
  return nearest.grip;
}

std::optional<Grip> axis_at(const Seen& s, Vec2 pixel) {
  const auto middle = s.pixel(s.gizmo.centre);
  if (!middle) return std::nullopt;
  if (length(pixel - *middle) < kGripReach) return Grip::all;
  for (int axis = 0; axis < 3; ++axis)
    if (s.has_plane(axis))
      if (const std::vector<Vec2> at = square_of(s, axis); !at.empty() && is_inside(pixel, at))
        return Grip(int(Grip::yz) + axis);
  Nearest nearest;
  for (int axis = 0; axis < 3; ++axis)
    if (const auto end = s.pixel(s.place(axis, 1)); end && s.has_axis(axis))
      nearest.offer(Grip(axis), distance_to(pixel, *middle, *end));
  return nearest.grip;
}

}  // namespace

Vec3 towards(const Gizmo& gizmo, const Walk& walk) {
  const trace::CameraRays rays(walk.shown.camera, walk.width, walk.height);
  return normalize(rays.orthographic ? rays.forward : gizmo.centre - rays.eye);
}

std::vector<Vec3> ring_of(const Gizmo& gizmo, int axis, const Walk& walk) {
  const float radius = gizmo_reach(walk) * metres_per_pixel(walk, gizmo.centre);
  const Vec3 u = column(gizmo.axes, (axis + 1) % 3), v = column(gizmo.axes, (axis + 2) % 3);
  std::vector<Vec3> out;
  for (int i = 0; i < kRingSteps; ++i) {
    const float angle = 2 * kPi * float(i) / kRingSteps;
    out.push_back(gizmo.centre + (u * std::cos(angle) + v * std::sin(angle)) * radius);
  }
  return out;
}

bool is_behind(const Gizmo& gizmo, Vec3 place, const Walk& walk) {
  const Vec3 out = place - gizmo.centre;
  return dot(out, towards(gizmo, walk)) > 0.05f * length(out);
}

float gizmo_reach(const Walk& walk) {
  return std::clamp(0.14f * float(std::min(walk.width, walk.height)), 36.0f, 130.0f);
}

std::optional<Grip> grip_at(const Gizmo& gizmo, const Walk& walk, Vec2 pixel) {
  if (!pixel_of(walk, gizmo.centre)) return std::nullopt;
  const Seen s = seen(gizmo, walk);
  return gizmo.tool == Tool::turn ? ring_at(s, pixel) : axis_at(s, pixel);
}

std::vector<Mark> marks_of(const Gizmo& gizmo, std::optional<Grip> lit, const Walk& walk) {
  std::vector<Mark> out;
  if (!pixel_of(walk, gizmo.centre)) return out;
  const Seen s = seen(gizmo, walk);
  std::vector<Stroke> strokes;
  if (gizmo.tool == Tool::turn) add_rings(s, lit, strokes);
  if (gizmo.tool != Tool::turn) add_squares(s, lit, strokes), add_axes(s, lit, strokes);
  // Dark below all of it, so that it stands out from what is bright.
  constexpr Rgb kDark{0.08f, 0.08f, 0.08f};
  for (const Stroke& stroke : strokes)
    out.push_back({stroke.from, stroke.to, stroke.radius + 1, kDark, kDark, 0});
  for (const Stroke& stroke : strokes)
    out.push_back({stroke.from, stroke.to, stroke.radius, stroke.color, stroke.color, 0});
  return out;
}

}  // namespace luxel::view
