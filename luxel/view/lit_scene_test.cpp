// Scenes whose vertices know their places in the lightmap, against the atlas that they are from.
#include "luxel/view/lit_scene.h"

#include <gtest/gtest.h>

namespace luxel::view {
namespace {

/// A square of two triangles of two materials, placed twice.
scene::Scene two_squares() {
  scene::Scene out;
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uv1 = {{7, 0}, {7, 1}, {7, 2}, {7, 3}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_material = {1, 0};
  out.meshes.push_back(mesh);
  out.instances.resize(2);
  out.instances[1].world_from_object.row[0][3] = 5;
  out.materials.resize(2);
  out.materials[0].base_color = {1, 0, 0}, out.materials[1].base_color = {0, 1, 0};
  return out;
}

/// On two pages of 8 texels: the first square in one piece on the first, the second one's triangles
/// apart on the second.
atlas::Atlas two_pages() {
  atlas::Atlas out;
  out.resolution = 16;
  out.pages = {{0, 0, 8}, {8, 0, 8}};
  out.first_triangle = {0, 2, 4};
  out.page = {0, 0, 1, 1};
  out.corners = {{{{1, 1}, {3, 1}, {3, 3}}},
                 {{{1, 1}, {3, 3}, {1, 3}}},
                 {{{9, 1}, {11, 1}, {11, 3}}},
                 {{{12, 1}, {14, 3}, {12, 3}}}};
  return out;
}

TEST(LitScene, VerticesLieWhereTheAtlasHasTheirTriangles) {
  const scene::Scene scene = two_squares();
  const atlas::Atlas atlas = two_pages();
  const LitScene lit = lit_scene(scene, atlas);
  ASSERT_EQ(lit.scene.instances.size(), 2u);
  // Corners are shared where charts hold together: 4 vertices; apart there are 6.
  EXPECT_EQ(lit.scene.meshes[0].positions.size(), 4u);
  EXPECT_EQ(lit.scene.meshes[1].positions.size(), 6u);
  for (uint32_t i = 0; i < 2; ++i) {
    const uint32_t m = lit.scene.instances[i].mesh;
    const scene::Mesh& mesh = lit.scene.meshes[m];
    EXPECT_EQ(lit.scene.instances[i].world_from_object, scene.instances[i].world_from_object);
    for (uint32_t t = 0; t < 2; ++t) {
      const uint32_t material = mesh.triangle_material[t];
      EXPECT_EQ(lit.material_of_scene[material], scene.meshes[0].triangle_material[t]);
      EXPECT_EQ(lit.scene.materials[material].base_color,
                scene.materials[lit.material_of_scene[material]].base_color);
      EXPECT_EQ(lit.page_of_material[material], i);
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t vertex = mesh.triangles[t][c];
        const uint32_t source = scene.meshes[0].triangles[t][c];
        const Vec2 corner = atlas.corners[2 * i + t][c];
        EXPECT_EQ(mesh.positions[vertex], scene.meshes[0].positions[source]);
        EXPECT_EQ(mesh.uv1[vertex], scene.meshes[0].uv1[source]) << "for textures that use it";
        EXPECT_EQ(lit.light_uv[m][vertex], (Vec2{(corner.x - 8 * float(i)) / 8, corner.y / 8}));
      }
    }
  }
}

}  // namespace
}  // namespace luxel::view
