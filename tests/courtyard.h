// A courtyard with a TEXCOORD_1 that is valid and cannot hold its light.
#pragma once

#include <cmath>

#include "luxel/atlas/atlas.h"
#include "luxel/scene/place_camera.h"
#include "luxel/scene/shapes.h"
#include "tests/support.h"

namespace luxel::testing_support {

/// The courtyard's meshes and instances by number.
enum CourtyardMesh : uint32_t { kGround, kWalls, kArches, kCanopy };

struct CourtyardParams {
  bool arches_inside_out = true;  ///< their fronts lie within the stone
  bool canopy = true;             ///< a sheet that is bent over a way, lit from above
};

/// A point of an arch in its plane: `angle` goes from 0 (right) over pi/2 (top) to pi (left).
inline Vec3 on_arch(float middle_x, float radius, float angle, float z) {
  return {middle_x + radius * std::cos(angle), 1.5f + radius * std::sin(angle), z};
}

/// Half a ring of stone on two pillars, closed, seen from outside.
inline void add_arch(scene::Mesh& mesh, float middle_x, uint32_t material) {
  constexpr int kSteps = 16;
  constexpr float kInner = 0.7f, kOuter = 1.0f, kNear = 0.25f, kFar = -0.25f;
  const auto at = [&](float r, int k, float z) {
    return on_arch(middle_x, r, float(k) * kPi / kSteps, z);
  };
  for (int k = 0; k < kSteps; ++k) {
    const int l = k + 1;
    const auto quad = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
      scene::add_quad(mesh, {a, b, c, d}, material);
    };
    quad(at(kOuter, k, kNear), at(kOuter, k, kFar), at(kOuter, l, kFar), at(kOuter, l, kNear));
    quad(at(kInner, k, kFar), at(kInner, k, kNear), at(kInner, l, kNear), at(kInner, l, kFar));
    quad(at(kInner, k, kNear), at(kOuter, k, kNear), at(kOuter, l, kNear), at(kInner, l, kNear));
    quad(at(kInner, k, kFar), at(kInner, l, kFar), at(kOuter, l, kFar), at(kOuter, k, kFar));
  }
  for (const float side : {-1.0f, 1.0f}) {
    const float x = middle_x + side * 0.85f;
    scene::add_box(mesh, {x - 0.15f, 0, kFar}, {x + 0.15f, 1.5f, kNear}, material);
  }
}

/// Gives every triangle vertices of its own and the coordinates of a layout without overlaps.
inline void lay_out_uv1(scene::Scene& scene) {
  Progress progress;
  const auto atlas =
      atlas::make_atlas(scene, {.uv = atlas::UvMode::unwrap, .resolution = 256}, progress);
  ASSERT_TRUE(atlas) << atlas.error().message;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    const std::vector<Vec3> positions = std::move(mesh.positions);
    mesh.positions.clear();
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (size_t k = 0; k < 3; ++k) {
        uint32_t& v = mesh.triangles[t][k];
        mesh.positions.push_back(positions[v]);
        mesh.uv1.push_back(atlas->corners[atlas->triangle_number(i, t)][k] * (1.0f / 256));
        v = uint32_t(mesh.positions.size()) - 1;
      }
  }
}

/// A court of 6 x 6 m between walls in the sun, with a row of arches of stone and a canopy. Every
/// material is double-sided, as many exporters say, and every mesh has a TEXCOORD_1.
inline scene::Scene courtyard(const CourtyardParams& params = {}) {
  scene::Scene scene;
  scene.name = "courtyard";
  const uint32_t stone = scene::add_material(scene, "stone", {0.65f, 0.6f, 0.5f});
  const uint32_t cloth = scene::add_material(scene, "cloth", {0.6f, 0.25f, 0.2f});
  scene.materials[stone].double_sided = scene.materials[cloth].double_sided = true;
  scene::add_rectangle(scene, {-3, 3, -3, 3}, 0, true, stone);
  scene::Mesh walls, arches, canopy;
  scene::add_box(walls, {-3.2f, 0, -3.2f}, {3.2f, 2.2f, -3}, stone);
  scene::add_box(walls, {-3.2f, 0, -3}, {-3, 2.2f, 3}, stone);
  scene::add_box(walls, {3, 0, -3}, {3.2f, 2.2f, 3}, stone);
  scene::place(scene, std::move(walls));
  for (const float x : {-2.0f, 0.0f, 2.0f}) add_arch(arches, x, stone);
  if (params.arches_inside_out)
    for (auto& [a, b, c] : arches.triangles) std::swap(b, c);
  scene::place(scene, std::move(arches));
  for (int k = 0; k < 8 && params.canopy; ++k) {
    const auto at = [&](int step, float z) {
      return on_arch(-1, 1.2f, float(step + 1) * kPi / 10, z) - Vec3{0, 0.3f, 0};
    };
    scene::add_quad(canopy, {at(k, -1), at(k, -2.5f), at(k + 1, -2.5f), at(k + 1, -1)}, cloth);
  }
  if (params.canopy) scene::place(scene, std::move(canopy));
  scene::PunctualLight sun;
  sun.name = "sun";
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{-0.5f, -0.8f, -0.6f});
  sun.intensity = {9, 8.5f, 7.5f};
  scene.lights.push_back(sun);
  scene.background = {0.5f, 0.7f, 1.0f};
  scene::place_camera(scene, "court", {2.2f, 1.9f, 4.6f}, {-0.3f, 1.1f, 0}, 0.9f);
  lay_out_uv1(scene);
  return scene;
}

}  // namespace luxel::testing_support
