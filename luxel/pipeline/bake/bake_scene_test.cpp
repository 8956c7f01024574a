#include "luxel/pipeline/bake/bake_scene.h"

#include <gmock/gmock.h>

#include "luxel/pipeline/bake/bake_report.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

BakeSettings small() {
  BakeSettings settings;
  settings.resolution = 32, settings.samples = 64;
  return settings;
}

// A pool of light on a black plain: one texel of 100, and next to nothing on the others. Hidden
// texels are none.
TEST(LitShare, IsThatOfTheTexelsWithNearlyAllLight) {
  TexelLight light;
  light.irradiance.assign(101, Rgb{1e-5f, 1e-5f, 1e-5f});
  light.hidden.assign(101, 0);
  light.irradiance[40] = {1, 1, 1}, light.irradiance[50] = {9, 9, 9}, light.hidden[50] = 1;
  EXPECT_EQ(lit_share(light), 0.01);
  light.irradiance.assign(101, Rgb{1, 1, 1});
  EXPECT_EQ(lit_share(light), 0.99);
  light.irradiance.assign(101, Rgb{});
  EXPECT_EQ(lit_share(light), 1);
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

// A scene that a file's reader would refuse is refused here, too, by the scene's name.
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

/// A Cornell box of 1 m, open towards +Z, with a lamp below its ceiling and a block on its floor,
/// sides and underside closed. Its TEXCOORD_1 gives each quad one of 4 x 4 cells, with a margin of
/// kMargin of it around, so that texels of the floor go on under the block.
constexpr float kMargin = 1.0f / 16;
constexpr float kBlock_m = 0.33f, kBlockHeight_m = 0.4f;  // half its width
scene::Scene box_with_uv1() {
  scene::Scene scene;
  const uint32_t white = scene::add_material(scene, "white", {0.7f, 0.7f, 0.7f});
  const uint32_t red = scene::add_material(scene, "red", {0.6f, 0.1f, 0.1f});
  const uint32_t lamp = scene::add_material(scene, "lamp", {0, 0, 0}, {10, 10, 10});
  scene::Mesh mesh;
  mesh.name = "box";
  const auto add = [&](const scene::Quad& quad, uint32_t material) {
    const auto first = uint32_t(mesh.positions.size()), cell = first / 4;
    const Vec2 corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (uint32_t k = 0; k < 4; ++k) {
      const Vec2 at = Vec2{kMargin, kMargin} + corners[k] * (1 - 2 * kMargin);
      mesh.positions.push_back(quad[k]);
      mesh.uv1.push_back((Vec2{float(cell % 4), float(cell / 4)} + at) * 0.25f);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.triangle_material.insert(mesh.triangle_material.end(), 2, material);
  };
  const float h = 0.5f, b = kBlock_m, top = kBlockHeight_m, l = 0.15f;
  add({Vec3{-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h}}, white);    // floor
  add({Vec3{-h, 1, -h}, {h, 1, -h}, {h, 1, h}, {-h, 1, h}}, white);    // ceiling
  add({Vec3{-h, 0, -h}, {h, 0, -h}, {h, 1, -h}, {-h, 1, -h}}, white);  // back
  add({Vec3{-h, 0, h}, {-h, 0, -h}, {-h, 1, -h}, {-h, 1, h}}, red);    // left
  add({Vec3{h, 0, -h}, {h, 0, h}, {h, 1, h}, {h, 1, -h}}, white);      // right
  add({Vec3{-l, 0.99f, -l}, {l, 0.99f, -l}, {l, 0.99f, l}, {-l, 0.99f, l}}, lamp);
  add({Vec3{-b, top, b}, {b, top, b}, {b, top, -b}, {-b, top, -b}}, white);
  add({Vec3{-b, 0, -b}, {b, 0, -b}, {b, 0, b}, {-b, 0, b}}, white);  // underside
  add({Vec3{-b, 0, b}, {b, 0, b}, {b, top, b}, {-b, top, b}}, white);
  add({Vec3{b, 0, -b}, {-b, 0, -b}, {-b, top, -b}, {b, top, -b}}, white);
  add({Vec3{b, 0, b}, {b, 0, -b}, {b, top, -b}, {b, top, b}}, white);
  add({Vec3{-b, 0, -b}, {-b, 0, b}, {-b, top, b}, {-b, top, -b}}, white);
  scene::place(scene, std::move(mesh));
  return scene;
}

// One rule for all solvers: what lies under the block is hidden and holds 0, but for two rings next
// to what is open, which are filled from there. 64 texels are 4 x 14 of the floor, 7 cm each.
TEST(BakeScene, HiddenTexelsHoldNothingWithAnySolver) {
  const float texel_m = 1 / (16 * (1 - 2 * kMargin));
  std::vector<uint8_t> hidden;
  for (const char* const solver : {"gather", "matrix", "hemicube", "hierarchical", "reference"}) {
    SCOPED_TRACE(solver);
    BakeSettings settings = small();
    settings.resolution = 64, settings.solver = solver;
    settings.own.of<hemicube::HemicubeParams>().max_elements = 500;
    settings.own.of<matrix::MatrixParams>().patches.count = 1024;
    settings.own.of<HierarchicalSettings>().mesh.discontinuities = false;
    Progress progress;
    const Result<Bake> bake = bake_scene(box_with_uv1(), settings, progress);
    ASSERT_TRUE(bake) << bake.error().message;
    ASSERT_TRUE(bake->atlas.kept);
    int deep = 0, filled = 0;
    for (size_t i = 0; i < bake->map.texels.size(); ++i) {
      const scene::SurfacePoint& p = bake->map.texels[i].sample;
      if (p.triangle > 1) continue;
      const Vec3 at = scene::world_position(bake->scene, p);
      const float inside_m = kBlock_m - std::max(std::abs(at.x), std::abs(at.z));
      const Rgb e = bake->light.irradiance[i];
      if (inside_m < -texel_m) {
        EXPECT_FALSE(bake->light.hidden[i]);
        EXPECT_GT(luminance(e), 0) << at.x << " " << at.z;
      } else if (inside_m > 3 * texel_m) {
        EXPECT_TRUE(bake->light.hidden[i]);
        EXPECT_EQ(e, Rgb{}) << at.x << " " << at.z;
        ++deep;
      } else if (bake->light.hidden[i] && inside_m < 1.5f * texel_m) {
        EXPECT_GT(luminance(e), 0) << at.x << " " << at.z;
        ++filled;
      }
    }
    EXPECT_GT(deep, 4);
    EXPECT_GT(filled, 20);
    if (hidden.empty()) hidden = bake->light.hidden;
    EXPECT_EQ(hidden, bake->light.hidden);
  }
}

}  // namespace
}  // namespace luxel::pipeline
