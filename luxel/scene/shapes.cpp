#include "luxel/scene/shapes.h"

#include <algorithm>

namespace luxel::scene {

uint32_t vertex_at(Mesh& mesh, Vec3 position) {
  const auto found = std::find(mesh.positions.begin(), mesh.positions.end(), position);
  const auto index = uint32_t(found - mesh.positions.begin());
  if (found == mesh.positions.end()) mesh.positions.push_back(position);
  return index;
}

void add_triangle(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, uint32_t material) {
  // In three statements: the order in which an initialiser list of calls adds vertices is fixed,
  // but a reader should not need to know that.
  const uint32_t i = vertex_at(mesh, a);
  const uint32_t j = vertex_at(mesh, b);
  const uint32_t k = vertex_at(mesh, c);
  mesh.triangles.push_back({i, j, k});
  mesh.triangle_material.push_back(material);
}

void add_quad(Mesh& mesh, const Quad& quad, uint32_t material) {
  add_triangle(mesh, quad[0], quad[1], quad[2], material);
  add_triangle(mesh, quad[0], quad[2], quad[3], material);
}

void add_quad_with_hole(Mesh& mesh, const Quad& quad, const Quad& hole, uint32_t material) {
  for (size_t i = 0; i < 4; ++i) {
    const size_t next = (i + 1) % 4;
    add_quad(mesh, {quad[i], quad[next], hole[next], hole[i]}, material);
  }
}

void add_box(Mesh& mesh, Vec3 lower, Vec3 upper, uint32_t material) {
  // Corner `bits` takes x, y, z from `upper` where bit 0, 1, 2 is set.
  const auto corner = [&](int bits) {
    return Vec3{bits & 1 ? upper.x : lower.x, bits & 2 ? upper.y : lower.y,
                bits & 4 ? upper.z : lower.z};
  };
  constexpr std::array<std::array<int, 4>, 6> kFaces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& f : kFaces)
    add_quad(mesh, {corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])}, material);
}

Mesh sphere(std::string name, float radius_m, int slices, int stacks, uint32_t material) {
  Mesh mesh;
  mesh.name = std::move(name);
  // The pole on top, rings downwards, the pole below.
  mesh.normals.push_back({0, 1, 0});
  for (int ring = 1; ring < stacks; ++ring)
    for (int slice = 0; slice < slices; ++slice) {
      const float theta = kPi * float(ring) / float(stacks);
      const float phi = 2 * kPi * float(slice) / float(slices);
      mesh.normals.push_back(normalize(Vec3{std::sin(theta) * std::cos(phi), std::cos(theta),
                                            -std::sin(theta) * std::sin(phi)}));
    }
  mesh.normals.push_back({0, -1, 0});
  for (const Vec3& n : mesh.normals) mesh.positions.push_back(n * radius_m);

  // Slice by slice: a triangle at each pole, two per quad in between.
  const auto at = [&](int ring, int slice) { return uint32_t(1 + (ring - 1) * slices + slice); };
  const auto bottom = uint32_t(mesh.normals.size() - 1);
  for (int slice = 0; slice < slices; ++slice) {
    const int next = (slice + 1) % slices;
    mesh.triangles.push_back({0, at(1, slice), at(1, next)});
    for (int ring = 1; ring + 1 < stacks; ++ring) {
      mesh.triangles.push_back({at(ring, slice), at(ring + 1, slice), at(ring + 1, next)});
      mesh.triangles.push_back({at(ring, slice), at(ring + 1, next), at(ring, next)});
    }
    mesh.triangles.push_back({bottom, at(stacks - 1, next), at(stacks - 1, slice)});
  }
  mesh.triangle_material.assign(mesh.triangles.size(), material);
  return mesh;
}

void place(Scene& scene, Mesh mesh, const Mat34& world_from_object) {
  scene.instances.push_back({mesh.name, uint32_t(scene.meshes.size()), world_from_object});
  scene.meshes.push_back(std::move(mesh));
}

void add_rectangle(Scene& scene, const std::array<float, 4>& sides, float y, bool up,
                   uint32_t material) {
  const auto [x0, x1, z0, z1] = sides;
  Mesh mesh;
  if (up)
    add_quad(mesh, {Vec3{x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0}}, material);
  else
    add_quad(mesh, {Vec3{x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1}}, material);
  place(scene, std::move(mesh));
}

uint32_t add_material(Scene& scene, std::string name, Rgb reflectance, Rgb emission) {
  Material material;
  material.name = std::move(name);
  material.base_color = reflectance;
  material.emission = emission;
  scene.materials.push_back(std::move(material));
  return uint32_t(scene.materials.size() - 1);
}

Mat34 look_at(Vec3 eye, Vec3 target, Vec3 up) {
  const Vec3 z = normalize(eye - target);  // a camera looks along its -z
  const Vec3 x = normalize(cross(up, z));
  return from_columns(x, cross(z, x), z, eye);
}

}  // namespace luxel::scene
