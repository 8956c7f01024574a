#include "luxel/scene/t_junctions.h"

#include <gtest/gtest.h>

#include "luxel/scene/pieces.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"
#include "tests/surfaces.h"

namespace luxel::scene {
namespace {

/// A tile of 2 x 2 m placed four times, turned and mirrored, and one with two sides between them.
Scene tiles() {
  Scene scene;
  add_material(scene, "stone", {0.5f, 0.5f, 0.5f});
  add_rectangle(scene, {-1, 1, -1, 1}, 0, true, 0);
  const Mat34 first = scene.instances[0].world_from_object;
  for (const float x : {2.0f, 4.0f, 6.0f}) {
    scene.instances.push_back({"tile", 0, first});
    scene.instances.back().world_from_object.row[0] = {x == 4 ? -1.0f : 1.0f, 0, 0, x};
  }
  add_rectangle(scene, {-1, 1, 1, 3}, 0, true, 0);
  const std::vector<uint8_t> both(2, 1);
  add_backs(scene, scene.instances.back().mesh, both);
  return scene;
}

/// A new vertex on the common edge of the tile and the sheet, and one on that of two tiles of one
/// mesh: both neighbours get it, and only they do.
TEST(TJunctions, NeighboursGetNewVertices) {
  Scene scene = tiles();
  scene.meshes.push_back(Mesh(scene.meshes[0]));
  scene.instances[0].mesh = 2;  // a tile that was cut
  std::vector<Uncut> before;
  for (const Instance& i : scene.instances)
    before.push_back({uint32_t(scene.meshes[i.mesh].positions.size()), {}});
  Mesh& cut = scene.meshes[2];
  const auto corners = cut.triangles;
  before[0].whole = corners;
  for (uint32_t t = 0; t < corners.size(); ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const auto [a, b, c] =
          std::array{corners[t][k], corners[t][(k + 1) % 3], corners[t][(k + 2) % 3]};
      const Vec3 p = cut.positions[a], q = cut.positions[b];
      if ((p.x != 1 || q.x != 1) && (p.z != 1 || q.z != 1)) continue;
      cut.positions.push_back(p * 0.3f + q * 0.7f);
      if (!cut.normals.empty()) cut.normals.push_back(Vec3(cut.normals[a]));
      if (!cut.uv0.empty()) cut.uv0.push_back(Vec2(cut.uv0[a]));
      const auto v = uint32_t(cut.positions.size() - 1);
      cut.triangles[t] = {a, v, c};
      before[0].whole.push_back(corners[t]);
      cut.triangles.push_back({v, b, c}), cut.triangle_material.push_back(0);
      break;
    }
  const auto part_of = close_t_junctions(scene, before);
  EXPECT_EQ(testing_support::count_t_junctions(testing_support::triangles_of(scene)), 0u);
  EXPECT_TRUE(part_of[0].empty());
  EXPECT_EQ(part_of[1].size(), 1u);
  EXPECT_TRUE(part_of[2].empty() && part_of[3].empty());
  EXPECT_EQ(scene.instances[2].mesh, 0u);
  const Mesh& sheet = scene.meshes[scene.instances[4].mesh];
  ASSERT_EQ(sheet.triangles.size(), 6u);
  for (uint32_t t = 0; t < 6; ++t) EXPECT_EQ(sheet.other_side[sheet.other_side[t]], t);
}

/// A sliver whose new corner lies on its own edge stays as it is: parts of it would have no area.
/// The triangle below it gets the vertex.
TEST(TJunctions, SliversAreNotDivided) {
  Scene scene;
  add_material(scene, "stone", {0.5f, 0.5f, 0.5f});
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, -1, 0}, {0.4f, 1e-8f, 0}};
  mesh.triangles = {{0, 1, 3}, {1, 0, 2}}, mesh.triangle_material = {0, 0};
  place(scene, mesh);
  const auto part_of = close_t_junctions(scene, {{3, mesh.triangles}});
  EXPECT_EQ(part_of[0], (std::vector<uint32_t>{1}));
  EXPECT_EQ(scene.meshes[0].triangles[0], (Corners{0, 1, 3}));
}

}  // namespace
}  // namespace luxel::scene
