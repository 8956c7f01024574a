// A house of sheets: what shines through a lightmap's walls.
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {

Scene closed_corner() {
  constexpr float kWall = 0.01f, kHeight = 2.4f, kEaves = 0.25f;
  constexpr float kX = 2, kZ = 1.5f;  // half the outer sides
  Scene scene;
  scene.name = "closed-corner";
  const uint32_t lawn = add_material(scene, "lawn", {0.3f, 0.45f, 0.2f});
  const uint32_t plaster = add_material(scene, "plaster", {0.8f, 0.78f, 0.72f});
  const uint32_t slate = add_material(scene, "slate", {0.35f, 0.37f, 0.42f});
  add_rectangle(scene, {-4, 4, -4, 4}, 0, true, lawn);
  scene.meshes.back().name = scene.instances.back().name = "lawn";
  Mesh house;
  house.name = "house";
  add_box(house, {-kX, 0, -kZ}, {kX, kHeight, -kZ + kWall}, plaster);
  add_box(house, {-kX, 0, kZ - kWall}, {kX, kHeight, kZ}, plaster);
  add_box(house, {-kX, 0, -kZ + kWall}, {-kX + kWall, kHeight, kZ - kWall}, plaster);
  add_box(house, {kX - kWall, 0, -kZ + kWall}, {kX, kHeight, kZ - kWall}, plaster);
  add_box(house, {-kX - kEaves, kHeight, -kZ - kEaves}, {kX + kEaves, kHeight + kWall, kZ + kEaves},
          slate);
  // Turned, so that no wall runs along the rows of texels of what it stands on.
  const float c = std::cos(0.35f), s = std::sin(0.35f);
  place(scene, std::move(house), {{{{c, 0, s, 0}, {0, 1, 0, 0}, {-s, 0, c, 0}}}});
  PunctualLight sun;
  sun.name = "sun";
  sun.kind = PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{-0.5f, -0.7f, -0.6f});
  sun.intensity = {9, 8.5f, 7.5f};
  sun.angular_radius_rad = 0.00465f;
  scene.lights.push_back(sun);
  scene.background = {0.5f, 0.7f, 1.0f};
  place_camera(scene, "outside", {5.2f, 3.4f, 6.4f}, {0, 0.8f, 0}, 0.8f);
  place_camera(scene, "inside", {-0.9f, 1.7f, -0.9f}, {1.2f, 0.5f, 1}, 1.2f);
  return scene;
}

}  // namespace luxel::scene
