#include "luxel/pipeline/texels/resolution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

/// Two squares of 1 m, 1 m apart. In TEXCOORD_1 they fill the left and the right half, with a gap
/// about the middle of this part of the map.
scene::Scene two_squares(float gap) {
  scene::Scene scene;
  const uint32_t m = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}}, m);
  scene::add_quad(mesh, {Vec3{2, 0, 0}, {3, 0, 0}, {3, 0, -1}, {2, 0, -1}}, m);
  const float left = 0.5f - gap / 2, right = 0.5f + gap / 2;
  mesh.uv1 = {{0, 1}, {left, 1}, {left, 0}, {0, 0}, {right, 1}, {1, 1}, {1, 0}, {right, 0}};
  scene::place(scene, std::move(mesh));
  return scene;
}

int settled_side(const scene::Scene& scene) {
  Progress progress;
  const auto settled = settle_resolution({}, kMostTexelsByDefault, scene, progress);
  EXPECT_TRUE(settled);
  return settled ? *settled->settings.resolution : 0;
}

std::string said_of(const scene::Scene& scene, int resolution) {
  Progress progress;
  BakeSettings settings;
  settings.resolution = resolution;
  const auto settled = settle_resolution(settings, kMostTexelsByDefault, scene, progress);
  atlas::AtlasParams params;
  params.resolution = resolution;
  const auto atlas = atlas::make_atlas(scene, params, progress);
  EXPECT_TRUE(settled && atlas);
  const auto text =
      about_blended(*settled, scene, *atlas, atlas::rasterise(scene, *atlas), progress);
  EXPECT_TRUE(text);
  return text.value_or("");
}

// A gap of 0.6 texels about the middle of the map, where two texels meet: look-ups 0.3 texels right
// of it blend in the texel left of it, whose centre is 0.8 away. At twice the resolution the gap is
// 1.2 texels, and no centre of the other side lies within one.
TEST(Resolution, KeepsTheChartsOfUv1Apart) {
  const int side = settled_side(two_squares(0.25f));
  ASSERT_GE(side, 64);
  const scene::Scene close = two_squares(0.6f / float(side));
  EXPECT_EQ(settled_side(close), 2 * side);
  EXPECT_EQ(said_of(close, 2 * side), "");
  EXPECT_THAT(said_of(close, side),
              ::testing::HasSubstr(fmt::format("--resolution {} would do", 2 * side)));
}

// The squares fill 2 m^2, whatever lies between them. Less time leaves fewer texels, enough time as
// many as no budget does.
TEST(Resolution, FitsATimeBudget) {
  const scene::Scene scene = two_squares(0.25f);
  const auto settled_within = [&](double seconds) {
    BakeSettings settings;
    settings.uv = atlas::UvMode::unwrap, settings.time_budget_s = seconds;
    Progress progress;
    return settle_resolution(settings, most_texels(settings), scene, progress);
  };
  const auto open = settled_within(0), much = settled_within(1e4), little = settled_within(0.1);
  ASSERT_TRUE(open && much && little);
  EXPECT_EQ(*much->settings.resolution, *open->settings.resolution);
  EXPECT_LT(*little->settings.resolution, *open->settings.resolution);
  const double density = little->chosen->texels_per_metre;
  EXPECT_LE(2 * density * density, little->most_texels);
  atlas::AtlasParams params;
  params.uv = atlas::UvMode::unwrap, params.resolution = *little->settings.resolution;
  Progress progress;
  const auto atlas = atlas::make_atlas(scene, params, progress);
  ASSERT_TRUE(atlas);
  const auto stats = atlas::atlas_stats(scene, *atlas, atlas::rasterise(scene, *atlas));
  EXPECT_THAT(about_resolution(*little, *atlas, stats),
              ::testing::HasSubstr("because --time-budget 0.1 leaves time for about"));
}

/// A square that faces up, and two that face down and meet along an edge. In TEXCOORD_1, of 64
/// texels, the first one's chart ends beside that edge, at x = `end`, and the second begins at
/// `begin`.
scene::Scene bright_beside_a_seam(float end, float begin) {
  scene::Scene scene;
  const uint32_t m = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh mesh;
  // By hand: the squares have vertices of their own, and so their own places in TEXCOORD_1.
  const auto add = [&](const std::array<Vec3, 4>& corners, Vec2 from, Vec2 to) {
    const auto first = uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
    for (const Vec2 uv : {from, Vec2{to.x, from.y}, to, Vec2{from.x, to.y}})
      mesh.uv1.push_back(uv * (1.0f / 64));
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.triangle_material.insert(mesh.triangle_material.end(), 2, m);
  };
  add({Vec3{0, 5, 1}, {1, 5, 1}, {1, 5, 0}, {0, 5, 0}}, {0, 0}, {end, 32});
  add({Vec3{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {begin, 0}, {64, 32});
  add({Vec3{-1, 0, 0}, {0, 0, 0}, {0, 0, 1}, {-1, 0, 1}}, {0, 33}, {31, 64});
  scene::place(scene, std::move(mesh));
  for (const float up : {-1.0f, 1.0f}) {
    scene::PunctualLight sun;
    sun.kind = scene::PunctualLight::Kind::directional;
    const float e = up < 0 ? 10 : 0.1f;
    sun.direction = {0, up, 0}, sun.intensity = {e, e, e};
    scene.lights.push_back(sun);
  }
  return scene;
}

// Both squares that face down get 0.1 W/m^2 everywhere. Look-ups on their edge blend in the texels
// of the third, which has a hundred times as much.
TEST(CloseCharts, StitchingSpreadsNoLightOfAnother) {
  BakeSettings settings;
  settings.uv = atlas::UvMode::keep, settings.resolution = 64, settings.bounces = 0;
  settings.samples = 4, settings.denoise = false;
  Progress progress;
  const auto bake = bake_scene(bright_beside_a_seam(31.7f, 32.3f), settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;
  EXPECT_GT(bake->seams, 0u);
  float largest = 0;
  for (size_t i = 0; i < bake->map.texels.size(); ++i)
    if (bake->map.texels[i].triangle_number >= 2)
      largest = std::max(largest, bake->light.irradiance[i].x);
  EXPECT_LT(largest, 0.1f * 1.0001f);  // rounding
}

// The 32 texels of column 31 belong to the second square, whose light is 0.1, and three tenths of
// each to the first, whose light is 10. The first has 31 x 32 texels of its own, the others
// 33 x 32 and 31 x 31. Nothing else errs: direct light of suns has no noise.
TEST(CloseCharts, TheStatedErrorCountsTheTexelsThatTheyShare) {
  BakeSettings settings;
  settings.uv = atlas::UvMode::keep, settings.resolution = 64, settings.bounces = 0;
  settings.samples = 4, settings.supersample = 1;
  const double texels = 31 * 32 + 33 * 32 + 31 * 31, mean = (31 * 32 * 9.9 + 0.1 * texels) / texels;
  const double off = std::sqrt(32 * 0.3 * 9.9 * 9.9 / texels) / mean;
  for (const bool denoise : {false, true}) {
    settings.denoise = denoise;
    Progress progress;
    const auto bake = bake_scene(bright_beside_a_seam(31.3f, 31.4f), settings, progress);
    ASSERT_TRUE(bake) << bake.error().message;
    const double stated = bake->light.delivered_error.value_or(bake->light.relative_error);
    EXPECT_NEAR(stated, off, 0.02 * off) << denoise;
  }
}

}  // namespace
}  // namespace luxel::pipeline
