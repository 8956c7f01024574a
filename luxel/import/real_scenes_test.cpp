// The shared scenes, against the triangle counts that their README states.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"
#include "tests/support.h"

namespace luxel::import {
namespace {

struct RealScene {
  const char* file;
  uint32_t triangles;   ///< drawn, by the README
  uint32_t degenerate;  ///< of these, how many have no area (counted by another program)
};
/// For the names of tests.
void PrintTo(const RealScene& p, std::ostream* out) { *out << p.file; }

/// The stated counts are of the files; living_room's is mostly triangles of exactly no area.
class RealScenes : public ::testing::TestWithParam<RealScene> {};

TEST_P(RealScenes, ImportsWithTheTrianglesOfTheReadme) {
  const std::string file = std::string("scenes/") + GetParam().file;
  LUXEL_NEEDS_SHARED(file);
  const auto imported = import_scene(testing_support::shared_folder() / file);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(scene::first_triangles(imported->scene).back(),
            GetParam().triangles - GetParam().degenerate);
}

INSTANTIATE_TEST_SUITE_P(
    Shared, RealScenes,
    ::testing::Values(RealScene{"cornell_box/cornell_box.glb", 32, 0},
                      RealScene{"tile_game_room/tile_game_room6.glb", 88, 0},
                      RealScene{"tile_game_room/tile_game_room_lit_uv1.glb", 90, 0},
                      RealScene{"living_room/living_room.glb", 5088, 3561},
                      RealScene{"living_room/living_room_lit_uv1.glb", 5086, 3560},
                      RealScene{"suzanne_room/room.glb", 63720, 0},
                      RealScene{"zdm2/zdm2.glb", 58772, 1164},
                      RealScene{"pandora/pandora.obj", 60810, 116},
                      RealScene{"kaykit_city/kaykit_city.glb", 54212, 8},
                      RealScene{"japanese_bridge_garden/japanese_bridge_garden.glb", 21883, 0},
                      RealScene{"japanese_bridge_garden/japanese_bridge_garden_meshopt.glb", 21883,
                                0},
                      RealScene{"spot_teapot_bunny/spot.obj", 5856, 0},
                      RealScene{"spot_teapot_bunny/teapot.obj", 6320, 0},
                      RealScene{"spot_teapot_bunny/stanford-bunny.obj", 69451, 0}));

/// A small file as other programs write them, and what its README says is right.
struct KnownFile {
  const char* file;
  float area_m2;
  uint32_t triangles;
  Vec3 upper;  ///< corner of its bounds
  const char* warned_of = "";
};
void PrintTo(const KnownFile& p, std::ostream* out) { *out << p.file; }

class KnownFiles : public ::testing::TestWithParam<KnownFile> {};

TEST_P(KnownFiles, HaveTheShapeOfTheReadme) {
  const std::string file = std::string("cases/") + GetParam().file;
  LUXEL_NEEDS_SHARED(file);
  const auto imported = import_scene(testing_support::shared_folder() / file);
  const scene::Scene scene = scene_of(imported);
  EXPECT_NEAR(drawn_area(scene), GetParam().area_m2, 1e-5f * GetParam().area_m2);
  EXPECT_EQ(scene::first_triangles(scene).back(), GetParam().triangles);
  expect_near(scene::world_bounds(scene).upper, GetParam().upper, 1e-5f);
  EXPECT_THAT(all_of(imported->warnings), ::testing::HasSubstr(GetParam().warned_of));
}

INSTANTIATE_TEST_SUITE_P(
    Shared, KnownFiles,
    ::testing::Values(
        KnownFile{"ngon-wrongly-triangulated/t.obj", 6, 6, {4, 3, 0}},
        KnownFile{"ngon-wrongly-triangulated/t.ply", 6, 6, {4, 3, 0}},
        KnownFile{"ngon-wrongly-triangulated/t.dae", 6, 6, {4, 3, 0}},
        KnownFile{"ngon-wrongly-triangulated/t.fbx", 6, 6, {4, 3, 0}},
        KnownFile{"ngon-wrongly-triangulated/notches.obj", 24.8f, 22, {5, 0, 0}},
        KnownFile{"obj-comment-after-face/comment.obj", 4, 2, {1, 0, 1}},
        KnownFile{"obj-latin1-object-name/door.obj", 4, 2, {1, 0, 1}},
        KnownFile{"obj-line-continuation/continued.obj", 4, 2, {1, 0, 1}},
        KnownFile{"morph-default-weights/lid.glb", 40, 4, {3, 1, 3}},
        KnownFile{"skin-node-transform/figure.glb", 18.76f, 14, {2, 1.8f, 2}},
        KnownFile{"texture-missing-or-tga/tga.obj", 4, 2, {1, 0, 1}},
        KnownFile{"texture-missing-or-tga/bmp.obj", 4, 2, {1, 0, 1}},
        KnownFile{"texture-missing-or-tga/case.obj", 4, 2, {1, 0, 1}},
        KnownFile{"texture-missing-or-tga/missing.obj", 4, 2, {1, 0, 1}, "is nothere.png, which"},
        KnownFile{"texture-missing-or-tga/absolute.fbx", 4, 2, {1, 0, 1}, "floor.png, which"}));

TEST(RealSceneParts, KaykitSharesMeshes) {
  LUXEL_NEEDS_SHARED("scenes/kaykit_city");
  const auto imported =
      import_scene(testing_support::shared_folder() / "scenes/kaykit_city/kaykit_city.glb");
  ASSERT_TRUE(imported);
  EXPECT_EQ(imported->scene.meshes.size(), 42u);
  EXPECT_EQ(imported->scene.instances.size(), 100u);
  EXPECT_EQ(imported->scene.materials.size(), 26u);
  EXPECT_EQ(imported->scene.textures.size(), 1u);
}

TEST(RealSceneParts, CornellBoxEmits) {
  LUXEL_NEEDS_SHARED("scenes/cornell_box");
  const auto imported =
      import_scene(testing_support::shared_folder() / "scenes/cornell_box/cornell_box.glb");
  ASSERT_TRUE(imported);
  Rgb most{};
  for (const scene::Material& m : imported->scene.materials) most = max(most, m.emission);
  EXPECT_NEAR(most.x, 17, 1e-4f);
  EXPECT_NEAR(most.y, 12, 1e-4f);
  EXPECT_NEAR(most.z, 4, 1e-4f);
}

}  // namespace
}  // namespace luxel::import
