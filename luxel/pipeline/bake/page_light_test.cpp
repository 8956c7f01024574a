#include "luxel/pipeline/bake/page_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

/// A block of 2 x 2 m that stands a centimetre deep in a slab, 8 texels per metre.
Bake block_on_a_slab() {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh slab;
  scene::add_box(slab, {-3, -1, -3}, {3, 0, 3}, gray);
  scene::place(scene, std::move(slab));
  scene::Mesh block;
  scene::add_box(block, {-1, -0.01f, -1}, {1, 1, 1}, gray);
  scene::place(scene, std::move(block));
  BakeSettings settings;
  settings.texels_per_metre = 8, settings.samples = 16, settings.uv = atlas::UvMode::unwrap;
  Progress progress;
  Result<Bake> bake = bake_scene(std::move(scene), settings, progress);
  EXPECT_TRUE(bake) << bake.error().message;
  return std::move(*bake);
}

// The bottom of the block is a chart of its own, black throughout. Its texels at the edges of the
// bottom take light, the darkest of the nearest; those farther inside do not, nor does the floor
// under the block, which has the light of its neighbours.
TEST(PageLight, BottomsTakeTheLightBesideThem) {
  const Bake bake = block_on_a_slab();
  const std::vector<Lent> lent = light_for_hidden(bake);
  const auto place = [&](uint32_t i) {
    return scene::world_position(bake.scene, bake.map.texels[i].sample);
  };
  std::map<uint32_t, uint32_t> from;
  for (const Lent& l : lent) from[l.texel] = l.from;
  size_t bottom = 0;
  for (uint32_t i = 0; i < bake.map.texels.size(); ++i) {
    const Vec3 p = place(i);
    const scene::SurfacePoint& at = bake.map.texels[i].sample;
    const bool is_bottom =
        at.instance == 1 && scene::front_normal(bake.scene, at.instance, at.triangle).y < -0.5f;
    const float inwards = 1 - std::max(std::abs(p.x), std::abs(p.z));
    const bool is_floor = at.instance == 0 && p.y == 0 && inwards < 0.1f;
    EXPECT_FALSE(is_floor && from.contains(i));
    if (!is_bottom) continue;
    ++bottom;
    EXPECT_TRUE(bake.light.hidden[i]);
    EXPECT_EQ(bake.light.irradiance[i], Rgb{});
    EXPECT_TRUE(inwards > 0.08f || from.contains(i)) << p.x << " " << p.z;
    EXPECT_TRUE(inwards < 0.25f || !from.contains(i)) << p.x << " " << p.z;
    if (!from.contains(i)) continue;
    const Rgb light = bake.light.irradiance[from[i]];
    EXPECT_FALSE(bake.light.hidden[from[i]]);
    float nearest = INFINITY;
    const auto for_open = [&](const auto& visit) {
      for (uint32_t j = 0; j < bake.map.texels.size(); ++j)
        if (!bake.light.hidden[j]) visit(j, length(place(j) - p));
    };
    for_open([&](uint32_t, float away) { nearest = std::min(nearest, away); });
    EXPECT_LE(length(place(from[i]) - p), 1.26f * nearest);
    for_open([&](uint32_t j, float away) {
      EXPECT_TRUE(away > 1.24f * nearest ||
                  luminance(bake.light.irradiance[j]) >= luminance(light));
    });
    EXPECT_GT(luminance(light), 0.1f);
  }
  EXPECT_GT(bottom, 200u);
}

TEST(PageLight, TheGutterIsMarked) {
  const Bake bake = block_on_a_slab();
  const std::vector<Lent> lent{{0, 5}};
  const std::vector<image::Image> pages = for_page(bake, lent, bake.lightmaps);
  const image::Image& before = bake.lightmaps[0];
  const atlas::Texel &first = bake.map.texels[0], &sixth = bake.map.texels[5];
  EXPECT_EQ(pages[0].rgb(first.x, first.y), before.rgb(sixth.x, sixth.y));
  size_t marked = 0;
  for (int y = 0; y < before.height; ++y)
    for (int x = 0; x < before.width; ++x) {
      const bool is_there =
          bake.map.texel_at[size_t(y) * size_t(before.width) + size_t(x)] != atlas::kNone;
      const float alpha = before.at(x, y)[3];
      EXPECT_EQ(pages[0].at(x, y)[3], is_there || alpha == 0 ? alpha : kDilatedAlpha);
      marked += pages[0].at(x, y)[3] == kDilatedAlpha;
      const bool is_first = x == first.x && y == first.y;
      EXPECT_TRUE(is_first || pages[0].rgb(x, y) == before.rgb(x, y));
    }
  EXPECT_GT(marked, 100u);
}

}  // namespace
}  // namespace luxel::pipeline
