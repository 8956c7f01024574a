// Light beneath leaves: masks, two sides, light scattered through.
#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/light/direct_light.h"
#include "luxel/scene/shapes.h"
#include "luxel/validate/own_scenes.h"

namespace luxel::validate {
namespace {

// The floor under twigs, texel by texel and in the mean, also of the texels in shadow alone. The
// judge follows every path by itself; gather reads the leaves' light from their texels, some four
// across a leaf.
TEST(SlowFoliage, LightBeneathLeavesIsThatOfThePathTracer) {
  Progress progress;
  const auto light = foliage_light(1024, progress);
  ASSERT_TRUE(light) << light.error().message;
  std::printf("floor: %zu texels, %zu in shadow; relative RMSE %.4f, mean %+.4f, shadow %+.4f\n",
              light->texels, light->in_shadow, light->floor.relative_rmse, light->mean - 1,
              light->shadow_mean - 1);
  EXPECT_TRUE(light->is_two_sided);
  EXPECT_GT(light->texels, 2000u);
  EXPECT_GT(light->in_shadow, 300u);
  EXPECT_LE(light->floor.relative_rmse, 0.02);
  EXPECT_NEAR(light->mean, 1, 0.01);
  EXPECT_NEAR(light->shadow_mean, 1, 0.02);
}

// A sun straight above a mask of random holes: the mean light below is what the holes let through.
TEST(Foliage, AMaskLetsThroughTheShareOfItsHoles) {
  constexpr int kCells = 32;
  scene::Scene s;
  scene::add_material(s, "floor", {});
  const uint32_t leaves = scene::add_material(s, "leaves", {});
  scene::Texture holes;
  holes.width = holes.height = kCells;
  RandomStream random{5};
  for (int k = 0; k < kCells * kCells; ++k)
    holes.rgba.insert(holes.rgba.end(), {0, 0, 0, uint8_t(random.next() < 0.6f ? 255 : 0)});
  // The floor lies under the middle 16 x 16 cells.
  double open = 0;
  for (int j = kCells / 4; j < 3 * kCells / 4; ++j)
    for (int i = kCells / 4; i < 3 * kCells / 4; ++i)
      open += holes.rgba[size_t(4 * (j * kCells + i) + 3)] == 0;
  open /= 0.25 * kCells * kCells;
  s.textures.push_back(std::move(holes));
  s.materials[leaves].base_color_texture = {.texture = 0, .filter = scene::Filter::nearest};
  s.materials[leaves].alpha_mode = scene::AlphaMode::mask;
  scene::add_rectangle(s, {-0.5f, 0.5f, -0.5f, 0.5f}, 0, true, 0);
  scene::add_rectangle(s, {-1, 1, -1, 1}, 1, false, leaves);
  for (const Vec3& p : s.meshes[1].positions)
    s.meshes[1].uv0.push_back({0.5f * p.x + 0.5f, 0.5f * p.z + 0.5f});
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.intensity = {4, 4, 4};
  s.lights.push_back(sun);
  Progress progress;
  const auto prepared = prepare(std::move(s), 256, progress);
  ASSERT_TRUE(prepared) << prepared.error().message;
  const Prepared& p = **prepared;
  const auto light = light::direct_light(p.scene, p.elements, p.lights, *p.tracer, {}, progress);
  ASSERT_TRUE(light);
  double sum = 0, texels = 0;
  for (size_t i = 0; i < p.map.texels.size(); ++i)
    if (p.map.texels[i].sample.instance == 0) sum += double(light->irradiance[i].x), ++texels;
  const double mean = sum / texels;
  ASSERT_GT(texels, 5000);
  // Cells are 5 texels wide or more; texels on their rims fall to either side at random.
  EXPECT_NEAR(mean, 4 * open, 0.01 * 4);
  EXPECT_GT(open, 0.3);
  EXPECT_LT(open, 0.5);
}

}  // namespace
}  // namespace luxel::validate
