#include "luxel/pipeline/texels/resolution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  const auto settled = settle_resolution({}, scene, progress);
  EXPECT_TRUE(settled);
  return settled ? *settled->settings.resolution : 0;
}

std::string said_of(const scene::Scene& scene, int resolution) {
  Progress progress;
  BakeSettings settings;
  settings.resolution = resolution;
  const auto settled = settle_resolution(settings, scene, progress);
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

}  // namespace
}  // namespace luxel::pipeline
