// A gallery: many narrow spots and a bright picture of many small lights.
#pragma once

#include <array>
#include <cmath>

#include "luxel/scene/place_camera.h"
#include "luxel/scene/scene.h"
#include "luxel/scene/shapes.h"

namespace luxel::testing_support {

namespace gallery {

inline constexpr float kSpot_rad = 0.13f;
inline constexpr float kX_m = 4, kZ_m = 2.5f, kHeight_m = 3.2f;  // half the room, and its height

inline void add_wall(scene::Scene& scene, const char* name, const scene::Quad& quad,
                     uint32_t material) {
  scene::Mesh mesh;
  mesh.name = name;
  scene::add_quad(mesh, quad, material);
  scene::place(scene, std::move(mesh));
}

inline void add_box(scene::Scene& scene, const char* name, Vec3 low, Vec3 high, uint32_t material) {
  scene::Mesh mesh;
  mesh.name = name;
  scene::add_box(mesh, low, high, material);
  scene::place(scene, std::move(mesh));
}

inline void add_spot(scene::Scene& scene, Vec3 from, Vec3 at, Rgb intensity, float cone_rad) {
  scene::PunctualLight light;
  light.kind = scene::PunctualLight::Kind::spot;
  light.position = from, light.direction = normalize(at - from), light.intensity = intensity;
  light.inner_cone_rad = 0.8f * cone_rad, light.outer_cone_rad = cone_rad;
  scene.lights.push_back(light);
}

/// The ceiling's slit (x0, x1, z0, z1), through which the sun throws a beam of 12 cm on the floor,
/// and where narrow spots, which hang low, throw circles as wide.
inline constexpr std::array<float, 4> kSlit{-2.66f, -2.54f, -1.5f, 0.8f};
inline constexpr std::array<Vec3, 2> kCircles{Vec3{-2.6f, 0, 1.5f}, {2.66f, 0, 1.66f}};
inline constexpr float kCircle_m = 0.06f;  // radius
inline constexpr Vec3 kSunTravels{0.1f, -1, 0.05f};

inline void add_ceiling(scene::Scene& scene, uint32_t material) {
  constexpr float x = kX_m, z = kZ_m, h = kHeight_m;
  const auto [x0, x1, z0, z1] = kSlit;
  scene::Mesh mesh;
  mesh.name = "ceiling";
  scene::add_quad_with_hole(mesh, {Vec3{-x, h, -z}, {x, h, -z}, {x, h, z}, {-x, h, z}},
                            {Vec3{x0, h, z0}, {x1, h, z0}, {x1, h, z1}, {x0, h, z1}}, material);
  scene::place(scene, std::move(mesh));
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(kSunTravels), sun.intensity = {60, 60, 55};
  sun.angular_radius_rad = 0.00465f;
  scene.lights.push_back(sun);
}

/// A wall of small lights: one pixel in 23 of 64 x 36 shines, the others glow at a hundredth of it.
inline scene::Texture wall_of_lights() {
  scene::Texture texture;
  texture.name = "lights", texture.width = 64, texture.height = 36;
  for (int k = 0; k < texture.width * texture.height; ++k) {
    const uint8_t v = (k * 7 + k / 64 * 5) % 23 == 0 ? 255 : 24;  // 24 of 255 is 0.009 in light
    texture.rgba.insert(texture.rgba.end(), {v, v, uint8_t(v * 3 / 4), 255});
  }
  return texture;
}

inline void add_screen(scene::Scene& scene) {
  scene.textures.push_back(wall_of_lights());
  const uint32_t shining = scene::add_material(scene, "screen", {0, 0, 0}, {300, 300, 300});
  scene.materials[shining].emission_texture.texture = 0;
  scene::Mesh mesh;
  mesh.name = "screen";
  const float z = -kZ_m + 0.02f;
  scene::add_quad(
      mesh, {Vec3{-1.2f, 0.7f, z}, {1.2f, 0.7f, z}, {1.2f, 2.05f, z}, {-1.2f, 2.05f, z}}, shining);
  mesh.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  scene::place(scene, std::move(mesh));
}

}  // namespace gallery

/// A room of 8 x 5 x 3.2 m: 20 spots, each with a sharp circle of 30 to 60 cm on a wall or on a
/// plinth, a screen of small bright lights, a partition that hides half of both, two spots with
/// circles of 12 cm, and a slit in the ceiling through which the sun shines.
inline scene::Scene gallery_of_spots() {
  using namespace gallery;
  scene::Scene scene;
  scene.name = "gallery";
  const uint32_t white = scene::add_material(scene, "white", {0.75f, 0.75f, 0.72f});
  const uint32_t floor = scene::add_material(scene, "floor", {0.35f, 0.28f, 0.2f});
  const uint32_t black = scene::add_material(scene, "frame", {0.06f, 0.06f, 0.06f});
  constexpr float x = kX_m, z = kZ_m, h = kHeight_m;
  add_wall(scene, "floor", {Vec3{-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z}}, floor);
  add_ceiling(scene, white);
  add_wall(scene, "back", {Vec3{-x, 0, -z}, {x, 0, -z}, {x, h, -z}, {-x, h, -z}}, white);
  add_wall(scene, "front", {Vec3{x, 0, z}, {-x, 0, z}, {-x, h, z}, {x, h, z}}, white);
  add_wall(scene, "left", {Vec3{-x, 0, z}, {-x, 0, -z}, {-x, h, -z}, {-x, h, z}}, white);
  add_wall(scene, "right", {Vec3{x, 0, -z}, {x, 0, z}, {x, h, z}, {x, h, -z}}, white);
  add_screen(scene);
  add_box(scene, "partition", {0.9f, 0, -0.6f}, {1.0f, 2.4f, 1.6f}, white);
  for (int k = 0; k < 6; ++k) {
    const float px = -3.2f + 1.28f * float(k), pz = k % 2 ? 0.5f : -0.9f;
    add_box(scene, "plinth", {px - 0.2f, 0, pz - 0.2f}, {px + 0.2f, 1, pz + 0.2f}, white);
    add_box(scene, "piece", {px - 0.08f, 1.02f, pz - 0.05f}, {px + 0.06f, 1.3f, pz + 0.07f}, black);
    add_spot(scene, {px + 0.3f, 3, pz + 0.2f}, {px, 1, pz}, {60, 55, 45}, kSpot_rad);
  }
  for (int k = 0; k < 7; ++k) {
    const float px = -3.3f + 1.1f * float(k);
    add_box(scene, "picture", {px - 0.25f, 1.3f, z - 0.03f}, {px + 0.25f, 1.9f, z}, black);
    add_spot(scene, {px, 3, z - 1.2f}, {px, 1.6f, z}, {40, 40, 36}, kSpot_rad);
    add_spot(scene, {px, 3, -z + 1.2f}, {px, 2.6f, -z}, {40, 40, 36}, kSpot_rad);
  }
  for (const Vec3 at : kCircles)
    add_spot(scene, at + Vec3{0, 1.3f, 0}, at, {56, 54, 48}, kCircle_m / 1.3f);
  scene::place_camera(scene, "door", {3.6f, 1.7f, 2.2f}, {-1, 1.2f, -1.2f}, 1.1f, 4.0f / 3);
  return scene;
}

}  // namespace luxel::testing_support
