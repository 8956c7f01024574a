#include "luxel/atlas/choose_resolution.h"

#include <gtest/gtest.h>

#include "luxel/atlas/atlas_test_support.h"

namespace luxel::atlas {
namespace {

SceneDetail detail(const scene::Scene& scene) {
  Progress progress;
  return detail_of(scene, {}, progress).value();
}

/// A cube of 1 m has six squares as charts and a diagonal of sqrt(3) m.
TEST(ChooseResolution, ACubeIsSeenAtTheDensityOfItsPicture) {
  const scene::Scene cube = testing::scene_of(testing::box({1, 1, 1}));
  const SceneDetail d = detail(cube);
  EXPECT_EQ(d.charts.size(), 6u);
  EXPECT_NEAR(d.area_m2, 6, 1e-6);
  EXPECT_NEAR(narrow_width_m(d), 1, 1e-6);
  const double density = kTexelsAcross / std::sqrt(3.0);
  EXPECT_NEAR(fine_density(d), density, 1e-3 * density);
  EXPECT_NEAR(texels_at(d, 10), 6 * 11 * 11, 1e-6);
  const ChosenResolution chosen = choose_resolution(cube, d, {}, 1e9);
  EXPECT_EQ(chosen.resolution, 768);  // 3 x 2 squares of 296 texels and their gutters
  EXPECT_FALSE(chosen.capped);
  // A fortieth of the texels: charts are shorter by the root of 40.
  const ChosenResolution few = choose_resolution(cube, d, {}, texels_at(d, density) / 40);
  EXPECT_TRUE(few.capped);
  EXPECT_NEAR(few.texels_per_metre, density / std::sqrt(40.0), 0.02 * few.texels_per_metre);
  EXPECT_EQ(few.resolution, 128);
}

/// Boards of 15 mm, a fifth of the area of the cube, ask for four texels across; a needle of less
/// than a thousandth of it for nothing.
TEST(ChooseResolution, NarrowPartsThatCountAskForMore) {
  scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  for (int k = 0; k < 20; ++k)
    testing::add_mesh(scene, testing::box({0.015f, 1, 0.015f}),
                      translation({1.5f + 0.2f * float(k % 5), 0, 0.2f * float(k / 5)}));
  const SceneDetail boards = detail(scene);
  EXPECT_NEAR(narrow_width_m(boards), 0.015, 1e-6);
  EXPECT_NEAR(fine_density(boards), kTexelsAcrossNarrow / 0.015, 0.1);
  EXPECT_GT(fine_density(boards), 1.2 * kTexelsAcross / boards.size_m);
  scene::Scene needle = testing::scene_of(testing::box({1, 1, 1}));
  testing::add_mesh(needle, testing::box({0.002f, 0.5f, 0.002f}), translation({0.5f, 1, 0.5f}));
  EXPECT_NEAR(narrow_width_m(detail(needle)), 1, 1e-6);
}

/// Densities may be off by a fifth, which advice leaves to spare
/// (luxel/pipeline/texels/resolution.cpp): charts that bend leave gaps in their rectangles.
TEST(ChooseResolution, ForeseesThePacker) {
  for (const scene::Scene& scene :
       {testing::mixed_scene(), testing::scene_of(testing::box({1, 2, 3})),
        testing::scene_of(testing::torus(32, 16))}) {
    Progress progress;
    const Atlas atlas = make_atlas(scene, {.resolution = 256}, progress).value();
    const TexelMap map = rasterise(scene, atlas);
    const double density = atlas_stats(scene, atlas, map).texels_per_metre;
    const SceneDetail d = detail(scene);
    EXPECT_NEAR(density_on(d, 256, 2), density, 0.2 * density);
    EXPECT_NEAR(texels_at(d, density), double(map.texels.size()), 0.1 * double(map.texels.size()));
  }
}

TEST(ChooseResolution, RoundsSidesUp) {
  EXPECT_EQ(round_side_up(1), 64);
  EXPECT_EQ(round_side_up(64.5), 96);
  EXPECT_EQ(round_side_up(700), 768);
  EXPECT_EQ(round_side_up(769), 1024);
  EXPECT_EQ(round_side_up(1e9), 16384);
}

/// Coordinates that the file brings and that fill a quarter of the square: twice the side.
TEST(ChooseResolution, KeepsTheDensityOfGivenCoordinates) {
  scene::Scene scene = testing::scene_of(testing::surface(1, 1, [](float u, float v) {
    return Vec3{u, 0, v};
  }));
  const SceneDetail d = detail(scene);
  const int unwrapped = choose_resolution(scene, d, {}, 1e9).resolution;
  for (const Vec3& p : scene.meshes[0].positions)
    scene.meshes[0].uv1.push_back({0.5f * p.x, 0.5f * p.z});
  EXPECT_EQ(choose_resolution(scene, d, {}, 1e9).resolution, 2 * unwrapped);
  EXPECT_EQ(choose_resolution(scene, d, {.uv = UvMode::unwrap}, 1e9).resolution, unwrapped);
}

}  // namespace
}  // namespace luxel::atlas
