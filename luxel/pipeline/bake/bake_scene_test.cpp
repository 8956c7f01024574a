#include "luxel/pipeline/bake/bake_scene.h"

#include <gmock/gmock.h>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

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

/// A floor in the sun, and a red box on it.
scene::Scene floor_with_box() {
  scene::Scene scene;
  scene::add_material(scene, "white", {0.8f, 0.8f, 0.8f});
  scene::add_material(scene, "red", {0.8f, 0.05f, 0.05f});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, 0);
  scene::Mesh box;
  box.name = "box";
  scene::add_box(box, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, 1);
  scene::place(scene, std::move(box));
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{1, -1, 0}), sun.intensity = {3, 3, 3};
  scene.lights.push_back(sun);
  return scene;
}

/// The mean light on the floor, and how many texels the box has.
struct BoxBake {
  Rgb floor{};
  size_t box_texels = 0;
};
BoxBake bake_box(bool lightmapped) {
  scene::Scene scene = floor_with_box();
  scene.instances[1].lightmapped = lightmapped;
  BakeSettings settings = small();
  settings.resolution = 96;
  Progress progress;
  const Result<Bake> bake = bake_scene(std::move(scene), settings, progress);
  EXPECT_TRUE(bake);
  BoxBake out;
  double count = 0;
  for (size_t i = 0; i < bake->map.texels.size(); ++i) {
    const scene::SurfacePoint& p = bake->map.texels[i].sample;
    if (p.instance == 1) ++out.box_texels;
    const Vec3 at = scene::world_position(bake->scene, p);
    if (p.instance != 0 || (std::abs(at.x) < 0.5f && std::abs(at.z) < 0.5f)) continue;
    out.floor += bake->light.irradiance[i], ++count;
  }
  out.floor = out.floor / float(count);
  return out;
}

// A box that is not lightmapped throws its shadow and its red light all the same, from a few
// texels: 1 % of the sunlit floor's light is what they may lose.
TEST(BakeScene, WhatIsNotLightmappedStillReflects) {
  const BoxBake whole = bake_box(true), left_out = bake_box(false);
  EXPECT_LT(left_out.box_texels * 10, whole.box_texels);
  EXPECT_GT(left_out.box_texels, 5u);
  EXPECT_GT(whole.floor.x, 1.02f * whole.floor.y) << "the box is red";
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(left_out.floor[c], whole.floor[c], 0.01f * whole.floor[c]) << c;
  EXPECT_NEAR(left_out.floor.x - left_out.floor.y, whole.floor.x - whole.floor.y,
              0.15f * (whole.floor.x - whole.floor.y));
}

}  // namespace
}  // namespace luxel::pipeline
