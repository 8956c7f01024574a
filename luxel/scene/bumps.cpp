// A bumpy floor, as a normal map and in relief.
#include <cmath>

#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

constexpr int kBumpsAcross = 6, kTexels = 64, kQuadsPerBump = 14;
constexpr float kSide = 1.5f;                  ///< of the floor [m]
constexpr float kBump = kSide / kBumpsAcross;  ///< from top to top
constexpr float kBumpHeight = 0.02f;

/// h = height (1 - cos 2 pi u) (1 - cos 2 pi v) / 4 over one bump, u and v in [0, 1].
float height_m(float u, float v) {
  return kBumpHeight * (1 - std::cos(2 * kPi * u)) * (1 - std::cos(2 * kPi * v)) / 4;
}

/// By u along +x and v along +z.
Vec3 bump_normal(float u, float v) {
  const float slope = kBumpHeight / kBump * 2 * kPi / 4;
  return normalize(Vec3{-slope * std::sin(2 * kPi * u) * (1 - std::cos(2 * kPi * v)), 1,
                        -slope * std::sin(2 * kPi * v) * (1 - std::cos(2 * kPi * u))});
}

/// One bump. v grows along +z, so green, which goes against v, holds -z.
Texture normal_map() {
  Texture t;
  t.name = "bump";
  t.width = t.height = kTexels;
  const auto byte = [](float x) { return uint8_t(std::lround((0.5f * x + 0.5f) * 255)); };
  for (int j = 0; j < kTexels; ++j)
    for (int i = 0; i < kTexels; ++i) {
      const Vec3 n =
          bump_normal((float(i) + 0.5f) / float(kTexels), (float(j) + 0.5f) / float(kTexels));
      t.rgba.insert(t.rgba.end(), {byte(n.x), byte(-n.z), byte(n.y), 255});
    }
  return t;
}

Mesh flat_floor(uint32_t material) {
  Mesh mesh;
  mesh.name = "floor";
  const float r = kSide / 2, n = float(kBumpsAcross);
  add_quad(mesh, {Vec3{-r, 0, r}, {r, 0, r}, {r, 0, -r}, {-r, 0, -r}}, material);
  mesh.uv0 = {{0, n}, {n, n}, {n, 0}, {0, 0}};
  return mesh;
}

Mesh floor_in_relief(uint32_t material) {
  Mesh mesh;
  mesh.name = "floor";
  const uint32_t cells = kBumpsAcross * kQuadsPerBump;
  for (uint32_t j = 0; j <= cells; ++j)
    for (uint32_t i = 0; i <= cells; ++i) {
      const float u = float(i) / kQuadsPerBump, v = float(j) / kQuadsPerBump;
      mesh.positions.push_back(
          {u * kBump - kSide / 2, height_m(u, v) - kBumpHeight / 4, v * kBump - kSide / 2});
      mesh.normals.push_back(bump_normal(u, v));
    }
  for (uint32_t j = 0; j < cells; ++j)
    for (uint32_t i = 0; i < cells; ++i) {
      const uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      mesh.triangles.push_back({a, c, d}), mesh.triangles.push_back({a, d, b});
      mesh.triangle_material.insert(mesh.triangle_material.end(), {material, material});
    }
  return mesh;
}

}  // namespace

Scene bumps(bool in_relief) {
  Scene scene;
  scene.name = in_relief ? "bumps-in-relief" : "bumps";
  const uint32_t clay = add_material(scene, "clay", {0.6f, 0.6f, 0.6f});
  const uint32_t wall = add_material(scene, "wall", {0.7f, 0.7f, 0.7f});
  const uint32_t warm = add_material(scene, "warm lamp", {}, {60, 34, 14});
  const uint32_t cool = add_material(scene, "cool lamp", {}, {12, 23, 46});
  if (in_relief) {
    place(scene, floor_in_relief(clay));
  } else {
    scene.textures.push_back(normal_map());
    scene.materials[clay].normal_texture.texture = 0;
    place(scene, flat_floor(clay));
  }
  Mesh back;
  back.name = "wall";
  const float r = kSide / 2;
  add_quad(back, {Vec3{-r, -0.02f, -r}, {r, -0.02f, -r}, {r, 0.8f, -r}, {-r, 0.8f, -r}}, wall);
  place(scene, std::move(back));
  add_rectangle(scene, {-1.25f, -1.0f, -0.1f, 0.15f}, 1.0f, false, warm);
  add_rectangle(scene, {1.0f, 1.25f, -0.2f, 0.05f}, 1.0f, false, cool);
  place_camera(scene, "above", {0.25f, 1.25f, 1.55f}, {0, 0.05f, -0.05f}, 0.8f);
  return scene;
}

}  // namespace luxel::scene
