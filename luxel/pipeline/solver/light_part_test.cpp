#include "luxel/pipeline/solver/light_part.h"

#include <gtest/gtest.h>

#include "luxel/base/vec_double.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

/// E per texel; stitching looks at the values themselves and would not add up.
std::vector<Rgb> light_by_part(const scene::Scene& scene, LightPart part, int samples = 64) {
  BakeSettings settings;
  settings.resolution = 48, settings.samples = samples, settings.light = part;
  settings.stitch = false;
  Progress progress;
  const auto bake = bake_scene(scene, settings, progress);
  EXPECT_TRUE(bake) << bake.error().message;
  return bake->light.irradiance;
}

double mean_red(std::span<const Rgb> light) {
  double sum = 0;
  for (const Rgb& e : light) sum += double(e.x);
  return sum / double(light.size());
}

// Walls that radiate L and reflect rho: pi L comes straight from them, and pi L rho / (1 - rho)
// after one reflection or more.
TEST(LightPart, OfTheFurnaceIsItsClosedForm) {
  const double rho = 0.6, direct = 2 * kPiDouble;
  const float r = float(rho);
  const scene::Scene box = scene::furnace_box({r, r, r}, {2, 2, 2});
  EXPECT_NEAR(mean_red(light_by_part(box, LightPart::direct)), direct, 0.005 * direct);
  const double indirect = direct * rho / (1 - rho);
  EXPECT_NEAR(mean_red(light_by_part(box, LightPart::indirect)), indirect, 0.01 * indirect);
  EXPECT_NEAR(mean_red(light_by_part(box, LightPart::no_punctual)), direct + indirect,
              0.01 * (direct + indirect));
}

/// A box on a floor under a sun and a sky, beside a lamp: every kind of source, and places nearer
/// to each other than a texel.
scene::Scene every_source() {
  scene::Scene scene;
  scene::add_material(scene, "floor", {0.7f, 0.5f, 0.4f});
  scene::add_material(scene, "lamp", {0.2f, 0.2f, 0.2f}, {3, 3, 3});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, 0);
  scene::Mesh box;
  box.name = "box";
  scene::add_box(box, {-0.5f, 0.01f, -0.5f}, {0.5f, 0.8f, 0.5f}, 0);
  scene::place(scene, std::move(box));
  scene::add_rectangle(scene, {0.8f, 1.2f, -0.2f, 0.2f}, 1, false, 1);
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{1, -2, 0.5f}), sun.intensity = {4, 4, 4};
  scene.lights.push_back(sun);
  scene.background = {0.5f, 0.6f, 0.8f};
  return scene;
}

// All parts are of the same rays: they add up but for rounding.
TEST(LightPart, DirectAndIndirectAddUp) {
  const scene::Scene scene = every_source();
  const auto all = light_by_part(scene, LightPart::all, 16);
  const auto direct = light_by_part(scene, LightPart::direct, 16);
  const auto indirect = light_by_part(scene, LightPart::indirect, 16);
  const auto rest = light_by_part(scene, LightPart::no_punctual, 16);
  ASSERT_EQ(all.size(), direct.size());
  double punctual = 0, reflected = 0;
  for (size_t i = 0; i < all.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(direct[i][c] + indirect[i][c], all[i][c], 1e-5f * (1 + all[i][c]));
      EXPECT_GE(indirect[i][c], 0);
      EXPECT_LE(indirect[i][c], rest[i][c] + 1e-5f);
      EXPECT_LE(rest[i][c], all[i][c] + 1e-5f);
      punctual += double(all[i][c]) - double(rest[i][c]), reflected += double(indirect[i][c]);
    }
  EXPECT_GT(punctual, 0) << "there is a sun";
  EXPECT_GT(reflected, 0);
}

// A plate in the open gets nothing back: from its own sky pi L, from the sun its cosine.
TEST(LightPart, KnowsSunFromSky) {
  scene::Scene scene;
  scene::add_material(scene, "plate", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true, 0);
  scene.background = {1, 1, 1};
  scene.lights.push_back({.name = {}, .kind = scene::PunctualLight::Kind::directional});
  for (const auto& [part, expected] : {std::pair{LightPart::all, kPi + 1},
                                       {LightPart::direct, kPi + 1},
                                       {LightPart::indirect, 0.0f},
                                       {LightPart::no_punctual, kPi}})
    for (const Rgb& e : light_by_part(scene, part)) EXPECT_NEAR(e.x, expected, 1e-4f);
}

// Errors are those of all light, relative to what is left.
TEST(LightPart, ErrorsAreRelativeToThePart) {
  gather::SourceLight sources{.punctual = {{6, 6, 6}, {0, 0, 0}}, .others = {{2, 2, 2}, {1, 1, 1}}};
  TexelLight light;
  light.irradiance = {{10, 10, 10}, {2, 2, 2}};
  light.errors = {0.1f, 0.2f};
  light.relative_error = 0.1;
  take_part(LightPart::indirect, sources, light);
  EXPECT_NEAR(light.irradiance[0].x, 2, 1e-6);
  EXPECT_NEAR(light.irradiance[1].x, 1, 1e-6);
  EXPECT_NEAR(light.errors[0], 0.5, 1e-6);
  EXPECT_NEAR(light.errors[1], 0.4, 1e-6);
  EXPECT_NEAR(light.relative_error, 0.4, 1e-6);
}

}  // namespace
}  // namespace luxel::pipeline
