#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/test_scenes.h"

namespace luxel::atlas {
namespace {

using ::testing::HasSubstr;

/// Two quads side by side in the map, one metre apart in the world.
scene::Scene two_quads() {
  scene::Mesh mesh;
  mesh.name = "quads";
  testing::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  testing::add_quad(mesh, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0});
  mesh.uv1 = {{0, 0.5f}, {0.5f, 0.5f}, {0.5f, 0}, {0, 0},
              {0.5f, 1}, {1, 1},       {1, 0.5f}, {0.5f, 0.5f}};
  return testing::scene_of(std::move(mesh));
}

Result<Atlas> make(const scene::Scene& scene, UvMode uv) {
  AtlasParams params;
  params.uv = uv;
  params.resolution = 16;
  Progress progress;
  return make_atlas(scene, params, progress);
}

TEST(KeepUv, CornersAreTheFilesCoordinates) {
  const scene::Scene scene = two_quads();
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_TRUE(atlas) << atlas.error().message;
  EXPECT_EQ(atlas->corners[0], (std::array<Vec2, 3>{{{0, 8}, {8, 8}, {8, 0}}}));
  EXPECT_EQ(atlas->chart, (std::vector<uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(rasterise(scene, *atlas).texels.size(), 128u);
}

TEST(KeepUv, NamesTheTrianglesThatOverlap) {
  scene::Scene scene = two_quads();
  for (int k = 4; k < 8; ++k) scene.meshes[0].uv1[k].x -= 0.25f, scene.meshes[0].uv1[k].y -= 0.25f;
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_FALSE(atlas);
  EXPECT_THAT(atlas.error().message, HasSubstr("in triangle 0 of mesh 'quads'"));
  EXPECT_THAT(atlas.error().message, HasSubstr("in triangle 3 of mesh 'quads'"));
}

TEST(KeepUv, NamesTheTriangleOutside) {
  scene::Scene scene = two_quads();
  scene.meshes[0].uv1[5].x = 1.5f;
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_FALSE(atlas);
  EXPECT_THAT(atlas.error().message,
              HasSubstr("triangle 2 of mesh 'quads' has TEXCOORD_1 (1.5, 1)"));
}

TEST(KeepUv, NotANumberIsOutside) {
  scene::Scene scene = two_quads();
  scene.meshes[0].uv1[5].x = NAN;
  EXPECT_FALSE(make(scene, UvMode::keep));
}

TEST(KeepUv, InstancesOfOneMeshShareAPlace) {
  scene::Scene scene = two_quads();
  scene.instances.push_back({"copy", 0, translation({0, 0, 5})});
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_FALSE(atlas);
  EXPECT_THAT(atlas.error().message, HasSubstr("share mesh 'quads'"));
  EXPECT_THAT(atlas.error().message, HasSubstr("--uv unwrap"));
}

TEST(KeepUv, AutomaticKeepsWhatIsValidAndUnwrapsTheRest) {
  scene::Scene scene = two_quads();
  const Result<Atlas> kept = make(scene, UvMode::automatic);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->corners[0][1], (Vec2{8, 8}));
  scene.meshes[0].uv1.clear();
  EXPECT_FALSE(make(scene, UvMode::keep));
  const Result<Atlas> unwrapped = make(scene, UvMode::automatic);
  ASSERT_TRUE(unwrapped);
  EXPECT_EQ(unwrapped->chart_count, 2u);
}

}  // namespace
}  // namespace luxel::atlas
