// A house with a sealed room beside sunlit ones: whatever light is found inside has come through
// the lightmap.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::testing_support {

/// The corners of the sealed room in plan, (x, z) in the house's own axes, along which its walls'
/// inner faces run. No two walls are at right angles.
inline constexpr std::array<Vec2, 5> kSealedRoom{
    {{-1.8f, 1.1f}, {0.6f, 1.6f}, {1.9f, 0.2f}, {1.1f, -1.7f}, {-1.5f, -1.3f}}};
inline constexpr float kRoomHeight = 2.2f;

struct SealedHouse {
  float wall_m = 0.1f;    ///< thickness of walls and roof
  float turn_rad = 0.3f;  ///< of the house on the lawn: walls run askew to the rows of its texels
};

/// Outwards from the wall that begins at corner k; its direction is the second.
inline std::array<Vec2, 2> wall_axes(size_t k) {
  const Vec2 d = kSealedRoom[(k + 1) % kSealedRoom.size()] - kSealedRoom[k];
  const Vec2 along = d * (1 / length(d));
  return {Vec2{-along.y, along.x}, along};
}

/// Where a place of the world lies in the house: plan and height.
inline Vec3 in_house(const SealedHouse& house, Vec3 p) {
  const float c = std::cos(house.turn_rad), s = std::sin(house.turn_rad);
  return {c * p.x - s * p.z, p.y, s * p.x + c * p.z};
}

/// A solid in the room, in axes of its own: x and z of the box's directions, its origin, and its
/// corners.
struct SolidBox {
  Vec2 x, z, at;
  Vec3 lower, upper;

  bool holds(Vec3 p) const {
    const Vec2 d = Vec2{p.x, p.z} - at;
    const Vec3 q{dot(d, x), p.y, dot(d, z)};
    return q.x > lower.x && q.x < upper.x && q.y > lower.y && q.y < upper.y && q.z > lower.z &&
           q.z < upper.z;
  }
};
inline constexpr float kSunk = -0.07f;
inline constexpr Vec2 kAskewX{0.9284767f, 0.3713907f}, kAskewZ{-0.3713907f, 0.9284767f},
    kAskewAt{0.2f, 0.3f};
/// A terrace and a kerb that run under walls, a screen of 1 cm, and a shell.
inline constexpr SolidBox kTerrace{
    kAskewX, kAskewZ, kAskewAt, {0.3f, kSunk, 0.2f}, {3.2f, 0.15f, 1.1f}},
    kKerb{kAskewX, kAskewZ, kAskewAt, {-3.1f, kSunk, -0.3f}, {0.2f, 0.08f, -0.18f}},
    kScreen{kAskewX, kAskewZ, kAskewAt, {-0.6f, kSunk, 0.6f}, {0.1f, 1.4f, 0.61f}},
    kShell{{1, 0}, {0, 1}, {0, 0}, {-0.9f, -0.01f, -0.8f}, {-0.2f, 0.6f, -0.2f}};

/// True for a place of the world in the sealed room, a tenth of a millimetre or more from its
/// walls, and not inside of a solid.
inline bool is_in_sealed_room(const SealedHouse& house, Vec3 world) {
  const Vec3 p = in_house(house, world);
  if (p.y < 1e-4f || p.y > kRoomHeight - 1e-4f) return false;
  for (size_t k = 0; k < kSealedRoom.size(); ++k)
    if (dot(Vec2{p.x, p.z} - kSealedRoom[k], wall_axes(k)[0]) > -1e-4f) return false;
  for (const SolidBox& box : {kTerrace, kKerb, kScreen, kShell})
    if (box.holds(p)) return false;
  return true;
}

/// A lawn that goes on under all walls and is the floor; five walls, some of which go on outside
/// as walls of open courts; a roof that is the ceiling and juts out as that of verandas; a terrace
/// and a kerb that run under walls; and furniture inside: a shell without a bottom, and a screen of
/// 1 cm. Sun and sky shine, and no ray comes in: walls are sunk into the lawn and reach into the
/// roof.
inline scene::Scene sealed_house(const SealedHouse& house) {
  using namespace scene;
  Scene out;
  out.name = "sealed-house";
  const uint32_t lawn = add_material(out, "lawn", {0.5f, 0.6f, 0.4f});
  const uint32_t plaster = add_material(out, "plaster", {0.8f, 0.78f, 0.72f});
  const uint32_t wood = add_material(out, "wood", {0.5f, 0.35f, 0.25f});
  add_rectangle(out, {-5, 5, -5, 5}, 0, true, lawn);
  const float c = std::cos(house.turn_rad), s = std::sin(house.turn_rad);
  // World from house, and a wall's own axes (along, up, outwards) at its first corner.
  const auto in_world = [&](Vec2 along, Vec2 outwards, Vec2 at) {
    const auto turned = [&](Vec2 v) { return Vec2{c * v.x + s * v.y, -s * v.x + c * v.y}; };
    const Vec2 u = turned(along), w = turned(outwards), o = turned(at);
    return Mat34{{{{u.x, 0, w.x, o.x}, {0, 1, 0, 0}, {u.y, 0, w.y, o.y}}}};
  };
  const auto add = [&](const char* name, Vec3 lower, Vec3 upper, uint32_t material,
                       const Mat34& place_at) {
    Mesh mesh;
    mesh.name = name;
    add_box(mesh, lower, upper, material);
    place(out, std::move(mesh), place_at);
  };
  const auto add_solid = [&](const char* name, const SolidBox& box, uint32_t material) {
    add(name, box.lower, box.upper, material, in_world(box.x, box.z, box.at));
  };
  constexpr float kTop = kRoomHeight + 0.03f;
  for (size_t k = 0; k < kSealedRoom.size(); ++k) {
    const auto [outwards, along] = wall_axes(k);
    const float width = length(kSealedRoom[(k + 1) % kSealedRoom.size()] - kSealedRoom[k]);
    // Walls overlap at corners; every other one goes on outside.
    const float more = k % 2 ? 1.3f : house.wall_m;
    add("wall", {-more, kSunk, 0}, {width + more, k % 2 ? 1.6f : kTop, house.wall_m}, plaster,
        in_world(along, outwards, kSealedRoom[k]));
    if (k % 2)
      add("wall", {-house.wall_m, 1.5f, 0}, {width + house.wall_m, kTop, house.wall_m}, plaster,
          in_world(along, outwards, kSealedRoom[k]));
  }
  add("roof", {-2.8f, kRoomHeight, -2.6f},
      {2.9f, kRoomHeight + std::max(house.wall_m, 0.04f), 2.6f}, wood,
      in_world({1, 0}, {0, 1}, {0, 0}));
  add_solid("terrace", kTerrace, wood);
  add_solid("kerb", kKerb, wood);
  add_solid("shell", kShell, wood);
  add_solid("screen", kScreen, plaster);
  PunctualLight sun;
  sun.name = "sun";
  sun.kind = PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{-0.5f, -0.7f, -0.6f});
  sun.intensity = {9, 8.5f, 7.5f};
  sun.angular_radius_rad = 0.00465f;
  out.lights.push_back(sun);
  out.background = {0.5f, 0.7f, 1.0f};
  place_camera(out, "outside", {6.2f, 4.4f, 6.4f}, {0, 0.8f, 0}, 0.8f);
  place_camera(out, "inside", {-0.9f, 1.7f, 0.2f}, {1.2f, 0.5f, 0}, 1.4f);
  return out;
}

}  // namespace luxel::testing_support
