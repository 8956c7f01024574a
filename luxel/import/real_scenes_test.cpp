// The shared scenes, against the triangle counts that their README states.
#include <gmock/gmock.h>

#include "luxel/import/import.h"
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
