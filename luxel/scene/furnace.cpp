// Closed scenes of one material, whose light is known in closed form.
#include <map>

#include "luxel/base/check.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

/// n x n quads on one wall of the unit cube, seen from inside. The wall faces along `axis`, towards
/// the cube's middle; `side` 0 or 1 is its coordinate on that axis.
void add_inward_wall(Mesh& mesh, int axis, int side, int n, uint32_t material) {
  // u, v, axis is a cyclic permutation of x, y, z, so u cross v points along +axis: the front side
  // of the wall at 0. The wall at 1 is wound the other way round.
  const auto point = [&](int i, int j) {
    // Both walls at an edge compute its vertices by this same division, so they meet exactly.
    std::array<float, 3> p{};
    p[size_t(axis)] = float(side);
    p[size_t(axis + 1) % 3] = float(i) / float(n);
    p[size_t(axis + 2) % 3] = float(j) / float(n);
    return Vec3{p[0], p[1], p[2]};
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Vec3 a = point(i, j), b = point(i + 1, j), c = point(i + 1, j + 1), d = point(i, j + 1);
      add_quad(mesh, side == 0 ? Quad{a, b, c, d} : Quad{a, d, c, b}, material);
    }
}

/// The regular icosahedron with corners on the unit sphere, seen from outside.
Mesh icosahedron() {
  const float g = 0.5f * (1.0f + std::sqrt(5.0f));
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& p : mesh.positions) p = normalize(p);
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return mesh;
}

/// Each triangle becomes four, the new vertices pushed out to the unit sphere.
void subdivide(Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), mesh.positions.size());
    if (is_new) mesh.positions.push_back(normalize(mesh.positions[a] + mesh.positions[b]));
    return entry->second;
  };
  std::vector<std::array<uint32_t, 3>> finer;
  finer.reserve(4 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.push_back({a, ab, ca});
    finer.push_back({b, bc, ab});
    finer.push_back({c, ca, bc});
    finer.push_back({ab, bc, ca});
  }
  mesh.triangles = std::move(finer);
}

}  // namespace

Scene furnace_box(Rgb reflectance, Rgb emission, int tessellation) {
  LUXEL_CHECK(tessellation >= 1 && tessellation <= 64);
  Scene scene;
  scene.name = "furnace";
  const uint32_t material = add_material(scene, "furnace", reflectance, emission);
  Mesh mesh;
  mesh.name = "furnace";
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) add_inward_wall(mesh, axis, side, tessellation, material);
  place(scene, std::move(mesh));
  return scene;
}

Scene inward_sphere(float radius_m, int levels, Rgb reflectance, Rgb emission) {
  LUXEL_CHECK(radius_m > 0 && levels >= 0 && levels <= 9);
  Scene scene;
  scene.name = "inward sphere";
  const uint32_t material = add_material(scene, "sphere", reflectance, emission);
  Mesh mesh = icosahedron();
  mesh.name = "sphere";
  for (int level = 0; level < levels; ++level) subdivide(mesh);
  for (Vec3& p : mesh.positions) p *= radius_m;
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  mesh.triangle_material.assign(mesh.triangles.size(), material);
  place(scene, std::move(mesh));
  return scene;
}

}  // namespace luxel::scene
