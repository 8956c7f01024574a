// Small scenes for the tests of this room.
#pragma once

#include <cmath>

#include "luxel/scene/scene.h"

namespace luxel::atlas::testing {

using scene::Scene;

/// A mesh as the only instance of a new scene with one material.
inline Scene scene_of(scene::Mesh mesh) {
  Scene s;
  s.materials.emplace_back();
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  s.meshes.push_back(std::move(mesh));
  s.instances.push_back({"one", 0, {}});
  return s;
}

inline void add_mesh(Scene& s, scene::Mesh mesh, Mat34 world_from_object = {}) {
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  s.meshes.push_back(std::move(mesh));
  s.instances.push_back({"", uint32_t(s.meshes.size() - 1), world_from_object});
}

inline void add_quad(scene::Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const auto first = uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A box from the origin; every side has its own vertices.
inline scene::Mesh box(Vec3 size) {
  scene::Mesh mesh;
  mesh.name = "box";
  const auto p = [&](int i) {
    return Vec3{i & 1 ? size.x : 0.0f, i & 2 ? size.y : 0.0f, i & 4 ? size.z : 0.0f};
  };
  for (const auto& s : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                        std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
    add_quad(mesh, p(s[0]), p(s[1]), p(s[2]), p(s[3]));
  return mesh;
}

/// A grid of quads over [0, 1]^2 through a function of two parameters.
template <class Surface>
scene::Mesh surface(int columns, int rows, Surface&& at) {
  scene::Mesh mesh;
  mesh.name = "surface";
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      mesh.positions.push_back(at(float(i) / float(columns), float(j) / float(rows)));
  const auto v = [&](int i, int j) { return uint32_t(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      mesh.triangles.push_back({v(i, j), v(i + 1, j), v(i + 1, j + 1)});
      mesh.triangles.push_back({v(i, j), v(i + 1, j + 1), v(i, j + 1)});
    }
  return mesh;
}

inline scene::Mesh torus(int columns, int rows) {
  return surface(columns, rows, [](float u, float v) {
    const float a = 2 * kPi * u, b = 2 * kPi * v, r = 1 + 0.4f * std::cos(b);
    return Vec3{r * std::cos(a), 0.4f * std::sin(b), -r * std::sin(a)};
  });
}

/// A ramp that winds three times around: seen from above it lies over itself.
inline scene::Mesh spiral_ramp() {
  return surface(90, 2, [](float u, float v) {
    const float a = 6 * kPi * u, r = 1 + v;
    return Vec3{r * std::cos(a), 0.9f * u, -r * std::sin(a)};
  });
}

/// Sixty blades of 2 m by 20 micrometres beside a box of 1 m.
inline Scene slivers() {
  Scene s = scene_of(box({1, 1, 1}));
  for (int k = 0; k < 60; ++k) {
    scene::Mesh blade;
    blade.name = "blade";
    const float z = 2.0f + float(k);
    blade.positions = {{0, 0, z}, {2, 0.3f, z}, {2, 0.30002f, z}};
    blade.triangles = {{0, 1, 2}};
    add_mesh(s, std::move(blade));
  }
  return s;
}

/// Bent, flat, folded and thin things at once.
inline Scene mixed_scene() {
  Scene s = scene_of(box({1, 2, 3}));
  add_mesh(s, torus(32, 16), translation({5, 0, 0}));
  add_mesh(s, spiral_ramp(), translation({-5, 0, 0}));
  s.instances.push_back({"mirrored", 0, translation({0, 0, 9}) * scaling({-1, 0.5f, 2})});
  for (const scene::Mesh& mesh : slivers().meshes)
    if (mesh.name == "blade") add_mesh(s, mesh);
  return s;
}

}  // namespace luxel::atlas::testing
