// A room in which things lie close to others: what tests of solvers of elements stand in.
#pragma once

#include <array>

#include "luxel/scene/scene.h"
#include "luxel/scene/shapes.h"

namespace luxel::test {

/// Construction of the rug and the picture.
enum class Thin : uint8_t { sheet, double_sided_sheet, box };

/// A closed room of 4 x 4 x 2.8 m with a lamp at its ceiling. Near the floor floats a rug, near the
/// wall at x = -2 a picture, and a table with a top of 2 cm stands on the floor.
struct ContactRoom {
  scene::Scene scene;
  /// True where light hardly comes: on the floor under the rug or on the rug's underside, on the
  /// wall behind the picture or on its back, `inside_m` or more from the border.
  bool is_covered(Vec3 p, Vec3 normal, float inside_m) const;
  /// True for a place in the open within `reach_m` of the rug or the picture, or on the table's
  /// top.
  bool is_near(Vec3 p, Vec3 normal, float reach_m) const;

  static constexpr float kGap_m = 0.005f, kThick_m = 0.01f;
  static constexpr std::array<float, 4> kRug{-1.2f, 0.8f, -0.3f, 1.1f};     // x0, x1, z0, z1
  static constexpr std::array<float, 4> kPicture{1.1f, 1.8f, -0.5f, 0.5f};  // y0, y1, z0, z1
  static constexpr std::array<float, 4> kTable{-0.2f, 1.2f, -1.5f, -0.7f};  // x0, x1, z0, z1
  static constexpr float kTableTop_m = 0.74f, kTableThick_m = 0.02f, kLeg_m = 0.05f;
  static constexpr float kHalf_m = 2, kHeight_m = 2.8f;
};

namespace contact_room {

/// Depth of (a, b) inside of a rectangle, negative outside [m].
inline float inside_by(const std::array<float, 4>& r, float a, float b) {
  return std::min(std::min(a - r[0], r[1] - a), std::min(b - r[2], r[3] - b));
}

inline void place_box(scene::Scene& scene, Vec3 low, Vec3 high, uint32_t material) {
  scene::Mesh box;
  scene::add_box(box, low, high, material);
  scene::place(scene, std::move(box));
}

inline void add_table(scene::Scene& scene) {
  using R = ContactRoom;
  const uint32_t wood = scene::add_material(scene, "wood", {0.5f, 0.4f, 0.3f});
  const auto [x0, x1, z0, z1] = R::kTable;
  const float under = R::kTableTop_m - R::kTableThick_m, inset = R::kLeg_m;
  place_box(scene, {x0, under, z0}, {x1, R::kTableTop_m, z1}, wood);
  for (const float x : {x0 + inset, x1 - inset - R::kLeg_m})
    for (const float z : {z0 + inset, z1 - inset - R::kLeg_m})
      place_box(scene, {x, 0, z}, {x + R::kLeg_m, under, z + R::kLeg_m}, wood);
}

inline void add_rug_and_picture(scene::Scene& scene, Thin thin) {
  using R = ContactRoom;
  const uint32_t rug = scene::add_material(scene, "rug", {0.6f, 0.25f, 0.2f});
  const uint32_t paint = scene::add_material(scene, "paint", {0.3f, 0.4f, 0.6f});
  const auto [x0, x1, z0, z1] = R::kRug;
  const auto [y0, y1, w0, w1] = R::kPicture;
  const float wall = -R::kHalf_m + R::kGap_m;
  if (thin == Thin::box) {
    place_box(scene, {x0, R::kGap_m, z0}, {x1, R::kGap_m + R::kThick_m, z1}, rug);
    place_box(scene, {wall, y0, w0}, {wall + R::kThick_m, y1, w1}, paint);
    return;
  }
  for (const uint32_t m : {rug, paint})
    scene.materials[m].double_sided = thin == Thin::double_sided_sheet;
  scene::add_rectangle(scene, R::kRug, R::kGap_m, true, rug);
  scene::Mesh picture;
  scene::add_quad(picture, {Vec3{wall, y0, w1}, {wall, y0, w0}, {wall, y1, w0}, {wall, y1, w1}},
                  paint);
  scene::place(scene, std::move(picture));
}

}  // namespace contact_room

inline ContactRoom contact_room_with(Thin thin) {
  using R = ContactRoom;
  ContactRoom room;
  const uint32_t plaster = scene::add_material(room.scene, "plaster", {0.7f, 0.7f, 0.7f});
  scene::Mesh shell;
  scene::add_box(shell, {-R::kHalf_m, 0, -R::kHalf_m}, {R::kHalf_m, R::kHeight_m, R::kHalf_m},
                 plaster);
  for (auto& [a, b, c] : shell.triangles) std::swap(b, c);  // seen from inside
  scene::place(room.scene, std::move(shell));
  const uint32_t lamp = scene::add_material(room.scene, "lamp", {0.5f, 0.5f, 0.5f}, {20, 20, 20});
  scene::add_rectangle(room.scene, {-0.4f, 0.4f, -0.4f, 0.4f}, R::kHeight_m - 0.01f, false, lamp);
  contact_room::add_rug_and_picture(room.scene, thin);
  contact_room::add_table(room.scene);
  return room;
}

inline bool ContactRoom::is_covered(Vec3 p, Vec3 normal, float inside_m) const {
  const float gap = 1.01f * kGap_m;
  const bool floor =
      p.y < gap && std::abs(normal.y) > 0.9f && (p.y < 0.5f * kGap_m || normal.y < 0);
  const bool wall = p.x < -kHalf_m + gap && std::abs(normal.x) > 0.9f &&
                    (p.x < -kHalf_m + 0.5f * kGap_m || normal.x < 0);
  return (floor && contact_room::inside_by(kRug, p.x, p.z) >= inside_m) ||
         (wall && contact_room::inside_by(kPicture, p.y, p.z) >= inside_m);
}

inline bool ContactRoom::is_near(Vec3 p, Vec3 normal, float reach_m) const {
  const float thin = kGap_m + 1.01f * kThick_m;
  const bool rug = p.y < thin && contact_room::inside_by(kRug, p.x, p.z) > -reach_m;
  const bool picture =
      p.x < -kHalf_m + thin && contact_room::inside_by(kPicture, p.y, p.z) > -reach_m;
  const bool table = std::abs(p.y - kTableTop_m) < 1.01f * kTableThick_m &&
                     contact_room::inside_by(kTable, p.x, p.z) > -1e-3f;
  return (rug || picture || table) && !is_covered(p, normal, -0.01f);
}

}  // namespace luxel::test
