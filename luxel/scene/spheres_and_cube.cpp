// Spheres and cube, after the description in [Moreno05, section 5.2]. The paper gives the objects,
// their colours and the number of triangles; sizes, places and light are ours.
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

// Two spheres of 2 * 16 * 7 = 224 triangles, the cube's 12, the ceiling's 8 around the lamp, the
// lamp's 2 and 2 for each of the other four walls: 478.
constexpr int kSlices = 16, kStacks = 8;

/// A box 2 m wide and high, 2 m deep, its floor at y = 0, open towards +z.
void place_open_box(Scene& scene, uint32_t gray, uint32_t green, uint32_t light) {
  const Vec3 a{-1, 0, -1}, b{1, 0, -1}, c{1, 0, 1}, d{-1, 0, 1};  // the floor, from the back left
  const Vec3 up{0, 2, 0};
  const auto add = [&](const char* name, const Quad& quad, uint32_t material) {
    Mesh mesh;
    mesh.name = name;
    add_quad(mesh, quad, material);
    place(scene, std::move(mesh));
  };
  add("floor", {a, d, c, b}, gray);
  add("back wall", {a, b, b + up, a + up}, gray);
  add("left wall", {d, a, a + up, d + up}, green);
  add("right wall", {b, c, c + up, b + up}, green);
  const auto inner = [&](Vec3 p) { return Vec3{0.3f * p.x, 2, 0.3f * p.z}; };
  const Quad lamp{inner(a), inner(b), inner(c), inner(d)};
  Mesh ceiling;
  ceiling.name = "ceiling";
  add_quad_with_hole(ceiling, {a + up, b + up, c + up, d + up}, lamp, gray);
  place(scene, std::move(ceiling));
  add("light", lamp, light);
}

Mat34 turned_about_y(float angle_rad) {
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  return from_columns({c, 0, -s}, {0, 1, 0}, {s, 0, c}, {});
}

}  // namespace

Scene spheres_and_cube() {
  Scene scene;
  scene.name = "spheres-and-cube";
  scene.background = {0.40f, 0.50f, 0.40f};
  const uint32_t gray = add_material(scene, "gray", {0.6f, 0.6f, 0.6f});
  const uint32_t green = add_material(scene, "green", {0.15f, 0.5f, 0.15f});
  const uint32_t red = add_material(scene, "red", {0.7f, 0.08f, 0.06f});
  const uint32_t yellow = add_material(scene, "yellow", {0.75f, 0.65f, 0.08f});
  const uint32_t light = add_material(scene, "light", {0, 0, 0}, {10, 10, 10});
  // Glossy paint, for those who look at luxel/display/local_light.h; the bake is diffuse.
  for (const uint32_t sphere_paint : {red, yellow}) {
    scene.materials[sphere_paint].specular = {0.4f, 0.4f, 0.4f};
    scene.materials[sphere_paint].sharpness = 30;
  }

  place_open_box(scene, gray, green, light);
  place(scene, sphere("red sphere", 0.38f, kSlices, kStacks, red),
        translation({-0.45f, 0.65f, -0.1f}));
  place(scene, sphere("yellow sphere", 0.32f, kSlices, kStacks, yellow),
        translation({0.5f, 1.25f, -0.35f}));
  Mesh cube;
  cube.name = "cube";
  add_box(cube, {-0.25f, -0.25f, -0.25f}, {0.25f, 0.25f, 0.25f}, gray);
  place(scene, std::move(cube), translation({0.4f, 0.45f, 0.3f}) * turned_about_y(0.5f));

  place_camera(scene, "front", {0, 1, 4.4f}, {0, 1, 0}, 0.65f, 1);
  return scene;
}

}  // namespace luxel::scene
