// Edits of what is drawn: a layout has other materials than the file.
#include "luxel/view/edit/drawn_edits.h"

#include <gmock/gmock.h>

#include "luxel/scene/sides.h"

namespace luxel::view {
namespace {

using ::testing::ElementsAre;

// A double-sided triangle gets a back, and with it a one-sided copy of its material, number 2; each
// page has a version of each.
TEST(DrawnEdits, VersionsOfMaterialsAreThoseThatWereRead) {
  scene::Scene as_read;
  as_read.materials.resize(2);
  as_read.materials[1].double_sided = true;
  scene::Mesh& mesh = as_read.meshes.emplace_back();
  mesh.positions.resize(3);
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}}, mesh.triangle_material = {1, 0};
  as_read.instances.resize(2);
  scene::Scene laid_out = as_read;
  scene::add_backs(laid_out, 0, std::array<uint8_t, 2>{1, 0});
  ASSERT_EQ(laid_out.materials.size(), 3u);
  ASSERT_EQ(laid_out.meshes[0].triangle_material[0], 2u);
  // As lit_scene() does: a mesh for each instance, on two pages.
  LitScene lit;
  lit.scene.instances = laid_out.instances;
  for (uint32_t i = 0; i < 2; ++i) {
    scene::Mesh& own = lit.scene.meshes.emplace_back(laid_out.meshes[0]);
    lit.scene.instances[i].mesh = i;
    for (uint32_t& material : own.triangle_material) material += 3 * i;
    for (uint32_t m = 0; m < 3; ++m) lit.material_of_scene.push_back(m);
  }
  lit.scene.materials.resize(6);
  EXPECT_THAT(materials_as_read(as_read, lit.scene, lit.material_of_scene),
              ElementsAre(0, 1, 1, 0, 1, 1));
  EXPECT_THAT(materials_as_read(as_read, as_read, {}), ElementsAre(0, 1));
  const auto outline = outline_of({.instance = 1, .material = 1},
                                  materials_as_read(as_read, lit.scene, lit.material_of_scene));
  ASSERT_TRUE(outline);
  EXPECT_EQ(outline->instance, 1u);
  EXPECT_THAT(outline->materials, ElementsAre(1, 2, 4, 5));
  EXPECT_FALSE(outline_of({.lamp = 0}, {}));
}

}  // namespace
}  // namespace luxel::view
