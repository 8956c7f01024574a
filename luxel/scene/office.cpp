// An office in the manner of [Hardt96, figure 7-1], which gives no sizes: about sixty
// quadrilaterals, two area lights.
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

constexpr float kWidth_m = 5, kDepth_m = 4, kHeight_m = 2.8f;

struct Paints {
  uint32_t white, wall, blue, floor, wood, chair, shelf, light;
};

/// A box without the faces that nobody sees: `open` holds bits for -x, +x, -y, +y, -z, +z.
void place_box(Scene& scene, const char* name, Vec3 lower, Vec3 upper, uint32_t material,
               unsigned open = 0) {
  Mesh box;
  add_box(box, lower, upper, material);
  Mesh mesh;
  mesh.name = name;
  mesh.positions = box.positions;
  for (size_t face = 0; face < 6; ++face) {
    if (open >> face & 1) continue;
    for (size_t t = 2 * face; t < 2 * face + 2; ++t) {
      mesh.triangles.push_back(box.triangles[t]);
      mesh.triangle_material.push_back(material);
    }
  }
  place(scene, std::move(mesh));
}
constexpr unsigned kLeft = 1, kRight = 2, kBottom = 4, kTop = 8, kBack = 16;

void place_room(Scene& scene, const Paints& p) {
  constexpr float x = kWidth_m / 2, z = kDepth_m / 2, h = kHeight_m;
  const auto add = [&](const char* name, const Quad& quad, uint32_t material) {
    Mesh mesh;
    mesh.name = name;
    add_quad(mesh, quad, material);
    place(scene, std::move(mesh));
  };
  add("floor", {{{-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z}}}, p.floor);
  add("ceiling", {{{-x, h, -z}, {x, h, -z}, {x, h, z}, {-x, h, z}}}, p.white);
  add("back wall", {{{-x, 0, -z}, {x, 0, -z}, {x, h, -z}, {-x, h, -z}}}, p.wall);
  add("front wall", {{{x, 0, z}, {-x, 0, z}, {-x, h, z}, {x, h, z}}}, p.wall);
  add("left wall", {{{-x, 0, z}, {-x, 0, -z}, {-x, h, -z}, {-x, h, z}}}, p.blue);
  add("right wall", {{{x, 0, -z}, {x, 0, z}, {x, h, z}, {x, h, -z}}}, p.wall);
  // They hang a hand below the ceiling, which they light by what comes back from below.
  const auto add_light = [&](const char* name, float x0, float x1) {
    add_rectangle(scene, {x0, x1, -0.35f, -0.05f}, 2.7f, false, p.light);
    scene.meshes.back().name = scene.instances.back().name = name;
  };
  add_light("light, left", -1.7f, -0.5f);
  add_light("light, right", 0.7f, 1.9f);
}

void place_desk(Scene& scene, const Paints& p) {
  place_box(scene, "desk top", {-1.9f, 0.71f, -1.6f}, {-0.1f, 0.75f, -0.8f}, p.wood);
  place_box(scene, "desk side, left", {-1.8f, 0, -1.5f}, {-1.76f, 0.71f, -0.9f}, p.wood,
            kBottom | kTop);
  place_box(scene, "desk side, right", {-0.24f, 0, -1.5f}, {-0.2f, 0.71f, -0.9f}, p.wood,
            kBottom | kTop);
  place_box(scene, "screen", {-1.3f, 0.8f, -1.4f}, {-0.7f, 1.2f, -1.36f}, p.chair);
}

void place_chair(Scene& scene, const Paints& p) {
  place_box(scene, "seat", {-1.25f, 0.42f, -0.55f}, {-0.75f, 0.48f, -0.05f}, p.chair);
  place_box(scene, "chair back", {-1.25f, 0.55f, -0.1f}, {-0.75f, 1.0f, -0.05f}, p.chair);
  place_box(scene, "chair leg", {-1.05f, 0, -0.35f}, {-0.95f, 0.42f, -0.25f}, p.chair,
            kBottom | kTop);
}

void place_shelf(Scene& scene, const Paints& p) {
  constexpr float back = -kDepth_m / 2, front = back + 0.35f;
  place_box(scene, "shelf side, left", {0.9f, 0, back}, {0.94f, 1.8f, front}, p.shelf,
            kBottom | kBack);
  place_box(scene, "shelf side, right", {2.16f, 0, back}, {2.2f, 1.8f, front}, p.shelf,
            kBottom | kBack);
  for (const float y : {0.4f, 1.0f, 1.6f})
    place_box(scene, "board", {0.94f, y, back}, {2.16f, y + 0.03f, front}, p.shelf,
              kLeft | kRight | kBack);
}

}  // namespace

Scene office() {
  Scene scene;
  scene.name = "office";
  Paints p{};
  p.white = add_material(scene, "white", {0.8f, 0.8f, 0.78f});
  p.wall = add_material(scene, "wall", {0.7f, 0.67f, 0.6f});
  p.blue = add_material(scene, "blue wall", {0.3f, 0.4f, 0.6f});
  p.floor = add_material(scene, "floor", {0.4f, 0.32f, 0.25f});
  p.wood = add_material(scene, "wood", {0.55f, 0.38f, 0.2f});
  p.chair = add_material(scene, "chair", {0.5f, 0.12f, 0.1f});
  p.shelf = add_material(scene, "shelf", {0.65f, 0.6f, 0.5f});
  p.light = add_material(scene, "light", {0, 0, 0}, {160, 150, 130});
  place_room(scene, p);
  place_desk(scene, p);
  place_chair(scene, p);
  place_shelf(scene, p);

  place_camera(scene, "door", {2.1f, 1.6f, 1.75f}, {-0.5f, 0.75f, -1.2f}, 0.95f, 4.0f / 3);
  place_camera(scene, "bird", {0.6f, 6.5f, 3.2f}, {0, 0.9f, -0.3f}, 0.75f, 4.0f / 3);
  return scene;
}

}  // namespace luxel::scene
