// A floor laid from a kit of tiles: what an atlas cuts into islands and the eye must see as one.
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

constexpr int kColumns = 5, kRows = 4;

/// A horizontal square of 1 m as cells x cells quads, its front up, its corner at the origin.
Mesh tile(const char* name, int cells, uint32_t material) {
  Mesh mesh;
  mesh.name = name;
  const float step = 1.0f / float(cells);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const float x0 = float(i) * step, x1 = float(i + 1) * step;
      const float z0 = float(j) * step, z1 = float(j + 1) * step;
      add_quad(mesh, {{{x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}, {x0, 0, z0}}}, material);
    }
  return mesh;
}

}  // namespace

Scene tiled_kit() {
  Scene scene;
  scene.name = "tiled-kit";
  const uint32_t stone = add_material(scene, "stone", {0.6f, 0.58f, 0.55f});
  const uint32_t brick = add_material(scene, "brick", {0.6f, 0.25f, 0.18f});
  const uint32_t lamp = add_material(scene, "lamp", {0.7f, 0.7f, 0.7f}, {60, 56, 48});
  scene.meshes.push_back(tile("plain tile", 1, stone));
  scene.meshes.push_back(tile("cut tile", 3, stone));
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      scene.instances.push_back(
          {"tile " + std::to_string(row) + std::to_string(column), uint32_t((row + column) % 2),
           translation({float(column) - 0.5f * kColumns, 0, float(row) - 0.5f * kRows})});
  Mesh pillar;
  pillar.name = "pillar";
  add_box(pillar, {-0.9f, 0, -0.35f}, {-0.6f, 1.4f, -0.05f}, brick);
  place(scene, std::move(pillar));
  add_rectangle(scene, {-1.9f, -1.3f, -1.1f, -0.5f}, 2.6f, false, lamp);
  scene.meshes.back().name = scene.instances.back().name = "lamp";
  place_camera(scene, "above", {1.6f, 3.4f, 4.2f}, {0.1f, 0, 0.1f}, 0.8f);
  return scene;
}

}  // namespace luxel::scene
