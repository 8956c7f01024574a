#include "luxel/pipeline/bake/bake_scene.h"

#include <gmock/gmock.h>

#include "luxel/scene/procedural.h"

namespace luxel::pipeline {
namespace {

BakeSettings small() {
  BakeSettings settings;
  settings.resolution = 32, settings.samples = 64;
  return settings;
}

// A closed box whose walls radiate L and reflect rho: everywhere E = pi L / (1 - rho).
TEST(BakeScene, BakesASceneInMemory) {
  const float emission = 2, reflectance = 0.5f;
  scene::Scene box =
      scene::furnace_box({reflectance, reflectance, reflectance}, {emission, emission, emission});
  Progress progress;
  const Result<Bake> bake = bake_scene(std::move(box), small(), progress);
  ASSERT_TRUE(bake) << bake.error().message;
  ASSERT_EQ(bake->lightmaps.size(), 1u);
  ASSERT_EQ(bake->map.texels.size(), bake->light.irradiance.size());
  double sum = 0;
  for (const Rgb e : bake->light.irradiance) sum += e.x;
  const double expected = double(kPi) * emission / (1 - reflectance);
  EXPECT_NEAR(sum / double(bake->light.irradiance.size()), expected, 0.01 * expected);
  EXPECT_GT(bake->preview.width, 0);
}

// What a file's reader would have refused is refused here, too, by the scene's name.
TEST(BakeScene, RefusesABrokenScene) {
  scene::Scene broken = scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  broken.name = "mine";
  broken.meshes[0].triangles[0][1] = 12345;
  Progress progress;
  const Result<Bake> bake = bake_scene(std::move(broken), small(), progress);
  ASSERT_FALSE(bake);
  EXPECT_EQ(bake.error().code, ErrorCode::bad_input);
  EXPECT_THAT(bake.error().message, testing::HasSubstr("mine"));
}

TEST(BakeScene, ChecksItsSettings) {
  BakeSettings settings = small();
  settings.solver = "guess";
  Progress progress;
  const Result<Bake> bake =
      bake_scene(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}), settings, progress);
  ASSERT_FALSE(bake);
  EXPECT_EQ(bake.error().code, ErrorCode::bad_setting);
}

}  // namespace
}  // namespace luxel::pipeline
