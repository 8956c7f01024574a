#include "luxel/post/touching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::post {
namespace {

/// Scenes of quads, each an instance of its own mesh, laid out as charts of 10 texels per metre,
/// one below the other: texel (x, y + 100 k) is 0.1 (x, y) along the first and the last side of
/// quad k.
struct Kit {
  scene::Scene scene;
  atlas::Atlas atlas;

  Kit() {
    scene.materials.resize(1);
    atlas.first_triangle = {0};
    atlas.resolution = 4096;
  }
  void add(const scene::Quad& quad) {
    scene::Mesh mesh;
    scene::add_quad(mesh, quad, 0);
    scene::place(scene, std::move(mesh));
    const float u = 10 * length(quad[1] - quad[0]), v = 10 * length(quad[3] - quad[0]);
    const float y = 100 * float(atlas.chart_count);
    atlas.corners.push_back({Vec2{0, y}, {u, y}, {u, y + v}});
    atlas.corners.push_back({Vec2{0, y}, {u, y + v}, {0, y + v}});
    atlas.chart.insert(atlas.chart.end(), {atlas.chart_count, atlas.chart_count});
    ++atlas.chart_count;
    atlas.first_triangle.push_back(uint32_t(atlas.corners.size()));
  }
  /// A tile on the floor, its front up: first side along x, last side along -z.
  void add_tile(float x, float z, float size, float lift = 0) {
    add({{{x, lift, z + size}, {x + size, lift, z + size}, {x + size, lift, z}, {x, lift, z}}});
  }
  std::vector<Seam> seams() const { return find_seams(scene, atlas); }
};

float length_of(const Seam& s) { return length(s.a1 - s.a0); }

TEST(Touching, TwoTilesShareAnEdge) {
  Kit kit;
  kit.add_tile(0, 0, 1), kit.add_tile(1, 0, 1);
  const std::vector<Seam> seams = kit.seams();
  ASSERT_EQ(seams.size(), 1u);
  // x = 1: the right side of the first chart, the left one of the second.
  const Seam s = seams[0];
  EXPECT_NEAR(s.a0.x, 10, 1e-4f);
  EXPECT_NEAR(s.a1.x, 10, 1e-4f);
  EXPECT_NEAR(s.b0.x, 0, 1e-4f);
  EXPECT_NEAR(s.b1.x, 0, 1e-4f);
  EXPECT_NEAR(s.a0.y, s.b0.y - 100, 1e-4f);
  EXPECT_NEAR(s.a1.y, s.b1.y - 100, 1e-4f);
  EXPECT_NEAR(length_of(s), 10, 1e-4f);
}

TEST(Touching, ATileOfAnotherSizeSharesPartOfAnEdge) {
  Kit kit;
  kit.add_tile(0, 0, 3);
  kit.add_tile(3, 0, 1), kit.add_tile(3, 0.75f, 1);  // they overlap each other, too
  std::vector<Seam> seams = kit.seams();
  // Both small tiles against the large one. Against each other: their sides at x = 3 lie on top of
  // each other with both tiles on one side, which is no surface that goes on.
  ASSERT_EQ(seams.size(), 2u);
  EXPECT_NEAR(seams[0].a0.x, 30, 1e-3f);
  EXPECT_NEAR(length_of(seams[0]), 10, 1e-3f);
  // z = 0 .. 1 is 30 .. 20 in the large chart, z = 0.75 .. 1.75 is 22.5 .. 12.5.
  EXPECT_NEAR(std::min(seams[0].a0.y, seams[0].a1.y), 20, 1e-3f);
  EXPECT_NEAR(std::min(seams[1].a0.y, seams[1].a1.y), 12.5f, 1e-3f);
}

TEST(Touching, TilesThatOnlyMeetInACornerDoNot) {
  Kit kit;
  kit.add_tile(0, 0, 1), kit.add_tile(1, 1, 1);
  EXPECT_EQ(kit.seams().size(), 0u);
}

// The tolerance is 1e-4 of the scene's diagonal, here of about 2.2 m.
TEST(Touching, WithinATolerance) {
  for (const auto& [gap, lift, count] :
       {std::tuple(1e-4f, 0.0f, 1u), {0.0f, 1e-4f, 1u}, {1e-3f, 0.0f, 0u}, {0.0f, 1e-3f, 0u}}) {
    Kit kit;
    kit.add_tile(0, 0, 1), kit.add_tile(1 + gap, 0, 1, lift);
    EXPECT_EQ(kit.seams().size(), count) << gap << " " << lift;
  }
}

/// A tile beyond the edge x = 1 of the first one, turned about that edge.
void add_turned(Kit& kit, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  kit.add({{{1, 0, 1}, {1 + c, s, 1}, {1 + c, s, 0}, {1, 0, 0}}});
}

TEST(Touching, CornersAreLeftAlone) {
  for (const auto& [angle, count] :
       {std::tuple(0.05f, 1u), {0.2f, 0u}, {-0.2f, 0u}, {kPi / 2, 0u}, {-kPi / 2, 0u}}) {
    Kit kit;
    kit.add_tile(0, 0, 1);
    add_turned(kit, angle);
    EXPECT_EQ(kit.seams().size(), count) << angle;
  }
}

TEST(Touching, TheFrontOfOneIsNotTheBackOfAnother) {
  Kit kit;
  kit.add_tile(0, 0, 1);
  kit.add({{{1, 0, 0}, {2, 0, 0}, {2, 0, 1}, {1, 0, 1}}});  // its front down
  EXPECT_EQ(kit.seams().size(), 0u);
}

TEST(Touching, ATileOnTopOfItselfIsNone) {
  Kit kit;
  kit.add_tile(0, 0, 1), kit.add_tile(0, 0, 1);
  EXPECT_EQ(kit.seams().size(), 0u);
}

TEST(Touching, AWallOnTheJointKeepsItsSidesApart) {
  for (const bool above : {true, false}) {
    Kit kit;
    kit.add_tile(0, 0, 1), kit.add_tile(1, 0, 1);
    const float y = above ? 1.0f : -1.0f;
    kit.add({{{1, 0, 0}, {1, 0, 1}, {1, y, 1}, {1, y, 0}}});
    EXPECT_EQ(kit.seams().size(), above ? 0u : 1u);
  }
}

// A splinter's edges are far shorter than the tolerance: looked for in cells of their own size they
// would take all memory there is.
TEST(Touching, SplintersAreNoBurden) {
  Kit kit;
  kit.add_tile(0, 0, 1), kit.add_tile(1, 0, 1);
  for (int k = 0; k < 100; ++k) kit.add_tile(0.01f * float(k), 0.5f, 1e-6f, 1);
  kit.add_tile(-1000, -1000, 1);  // so that the tolerance is 0.2 m
  EXPECT_EQ(kit.seams().size(), 1u);
}

// 60 x 60 tiles at random heights of a millionth, each with three or four neighbours: 2 * 60 * 59
// joints, whatever their order and wherever they lie.
TEST(Touching, FindsEveryJointOfAFieldOfTiles) {
  constexpr int kCount = 60;
  for (const float offset : {0.0f, -317.3f}) {
    Kit kit;
    RandomStream random{4};
    for (int k = 0; k < kCount * kCount; ++k)
      kit.add_tile(offset + float(k % kCount), offset + float(k / kCount), 1,
                   1e-6f * random.next());
    EXPECT_EQ(kit.seams().size(), size_t(2 * kCount * (kCount - 1))) << offset;
  }
}

// There are 31 = 4 * 4 + 3 * 5 joints; each is a whole edge against thirds.
TEST(Touching, FindsTheJointsOfTheTiledKit) {
  const scene::Scene scene = scene::tiled_kit();
  Progress progress;
  const auto atlas = atlas::make_atlas(scene, {.resolution = 256}, progress);
  ASSERT_TRUE(atlas);
  EXPECT_EQ(find_seams(scene, *atlas).size(), 3u * 31);
}

TEST(SeamResidual, IsAlsoSaidRelativeToTheLightAround) {
  // One seam from (1, 0) to (1, 10), both sides sampled in columns of their own: 1 against 1.2 in
  // the upper half, a thousand times darker in the lower one, where only 1 % is missing.
  atlas::TexelMap map;
  map.resolution = 10;
  map.texel_at.assign(100, atlas::kNone);
  std::vector<Rgb> values;
  for (const uint32_t x : {0u, 8u})
    for (uint32_t y = 0; y < 10; ++y) {
      map.texel_at[y * 10 + x] = uint32_t(map.texels.size());
      map.texels.push_back({uint16_t(x), uint16_t(y), {}, 0, true});
      const float light = y < 5 ? 1.0f : 1e-1f;
      values.push_back(Rgb{1, 1, 1} * (light * (x == 0 ? 1.0f : y < 5 ? 1.2f : 1.01f)));
    }
  const std::vector<Seam> seams{{{0.5f, 0}, {0.5f, 10}, {8.5f, 0}, {8.5f, 10}}};
  const SeamResidual r = seam_residual(map, seams, values);
  EXPECT_NEAR(r.relative_max, 0.2 / 1.1, 1e-3);
  EXPECT_NEAR(r.relative_p95, 0.2 / 1.1, 1e-3);
  // 20 points, one of them between the halves: 0.05 of each of its sides' light.
  EXPECT_NEAR(r.rms_over_mean, std::sqrt(0.5 * 0.2 * 0.2) / (0.5 * 1.1 + 0.5 * 0.1005), 0.02);
}

}  // namespace
}  // namespace luxel::post
