#include <gtest/gtest.h>

#include <cstring>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/atlas_test_support.h"
#include "luxel/atlas/cover.h"
#include "luxel/base/random.h"
#include "luxel/base/team_test_support.h"

namespace luxel::atlas {
namespace {

Atlas atlas_of(int resolution, std::vector<std::array<Vec2, 3>> corners) {
  Atlas a;
  a.resolution = resolution;
  a.first_triangle = {0, uint32_t(corners.size())};
  a.chart.assign(corners.size(), 0);
  a.chart_count = 1;
  a.corners = std::move(corners);
  return a;
}

TEST(Rasterise, ClipsSumToTheTrianglesArea) {
  RandomStream random{3};
  for (int k = 0; k < 200; ++k) {
    std::array<DVec2, 3> c;
    for (DVec2& p : c) p = to_double(random.next2() * 9.0f);
    const UvTriangle t = uv_triangle(c);
    double area = 0;
    DVec2 moment;
    const Span rows = touched_rows(t);
    for (int j = rows.begin; j < rows.end; ++j) {
      const Span s = touched_texels(t, j);
      for (int i = s.begin; i < s.end; ++i) {
        const Clip clip = clip_to_texel(t, i, j);
        EXPECT_GT(clip.area, 0) << "touched without area";
        area += clip.area;
        moment = moment + clip.centroid * clip.area;
      }
    }
    EXPECT_NEAR(area, t.area2 / 2, 1e-9);
    const DVec2 centroid = (c[0] + c[1] + c[2]) * (1.0 / 3);
    EXPECT_NEAR(moment.x, centroid.x * area, 1e-8);
    EXPECT_NEAR(moment.y, centroid.y * area, 1e-8);
  }
}

TEST(Rasterise, EdgesThroughTexelCornersTouchOneSideOnly) {
  const UvTriangle t = uv_triangle({{{0, 0}, {4, 0}, {0, 4}}});
  EXPECT_EQ(touched_rows(t).end, 4);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(touched_texels(t, j).begin, 0);
    EXPECT_EQ(touched_texels(t, j).end, 4 - j);
    EXPECT_EQ(centre_texels(t, j, CentreRule::inside_or_border).end, 4 - j);
    const Span strict = centre_texels(t, j, CentreRule::strictly_inside);
    EXPECT_EQ(strict.end - strict.begin, 3 - j);
  }
}

TEST(Rasterise, CentreWinsOverAreaAndAreaOverNumber) {
  // Texel (0, 0): triangle 1 holds its centre. Texel (2, 0): no centre; triangle 3 covers more.
  const Atlas atlas = atlas_of(4, {{{{0, 0}, {0.4f, 0}, {0, 1}}},
                                   {{{0.4f, 0}, {1, 0}, {0.4f, 1}}},
                                   {{{2.9f, 0}, {3, 0}, {3, 0.1f}}},
                                   {{{2, 0}, {2.4f, 0}, {2, 0.4f}}}});
  const TexelMap map = rasterise({}, atlas);
  ASSERT_EQ(map.texels.size(), 2u);
  EXPECT_EQ(map.texels[0].triangle_number, 1u);
  EXPECT_TRUE(map.texels[0].centre_covered);
  EXPECT_EQ(map.texels[1].triangle_number, 3u);
  EXPECT_FALSE(map.texels[1].centre_covered);
  // The sample is the centroid of the clip: here the whole triangle.
  EXPECT_NEAR(map.texels[1].sample.at.u, 1.0 / 3, 1e-4);
  EXPECT_NEAR(map.texels[1].sample.at.v, 1.0 / 3, 1e-4);
}

TEST(Rasterise, SharedEdgeThroughCentresGoesToTheLowerNumber) {
  const Atlas atlas = atlas_of(4, {{{{0, 0}, {4, 0}, {4, 4}}}, {{{0, 0}, {4, 4}, {0, 4}}}});
  const TexelMap map = rasterise({}, atlas);
  EXPECT_EQ(map.texels.size(), 16u);
  for (uint32_t k = 0; k < 4; ++k) EXPECT_EQ(map.texels[map.texel_at[5 * k]].triangle_number, 0u);
}

TEST(Rasterise, TrianglesWithoutAreaAndOnTheBorderGetTexels) {
  const Atlas atlas =
      atlas_of(4, {{{{0.5f, 1.5f}, {3.5f, 1.5f}, {2, 1.5f}}}, {{{4, 4}, {4, 4}, {4, 4}}}});
  const TexelMap map = rasterise({}, atlas);
  ASSERT_EQ(map.texels.size(), 5u);
  EXPECT_EQ(map.texels[4].x, 3u);
  EXPECT_EQ(map.texels[4].y, 3u);
  for (const Texel& t : map.texels) {
    EXPECT_GT(t.sample.at.u, 0);
    EXPECT_GT(t.sample.at.v, 0);
    EXPECT_LT(t.sample.at.u + t.sample.at.v, 1);
  }
}

// Squeezed to lines on the lower and the right border of the first of two pages, with a gap
// between.
TEST(Rasterise, TrianglesOnTheBorderOfAPageStayOnIt) {
  Atlas atlas = atlas_of(22, {{Vec2{1, 10}, Vec2{5, 10}, Vec2{9, 10}},
                              {Vec2{10, 1}, Vec2{10, 5}, Vec2{10, 9}},
                              {Vec2{13, 1}, Vec2{21, 1}, Vec2{13, 9}}});
  atlas.pages = {{0, 0, 10}, {12, 0, 10}};
  atlas.page = {0, 0, 1};
  std::array<size_t, 3> texels{};
  for (const Texel& t : rasterise({}, atlas).texels) {
    ++texels[t.triangle_number];
    EXPECT_LT(t.y, 10);
    if (t.triangle_number < 2) {
      EXPECT_LT(t.x, 10);
    }
  }
  for (const size_t count : texels) EXPECT_GT(count, 0u);
}

// 20 bands of rows for three members: triangles that reach over several bands, and empty ones.
TEST(Rasterise, IsSharedOutByATeam) {
  std::vector<std::array<Vec2, 3>> corners(50);
  RandomStream random{8};
  for (auto& c : corners)
    for (Vec2& p : c) p = random.next2() * 250.0f;
  const Atlas atlas = atlas_of(320, std::move(corners));
  const TexelMap expected = rasterise({}, atlas);
  as_team(3, [&](Team& team) {
    Progress progress;
    const auto map = rasterise_together({}, atlas, &team, nullptr, progress);
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_EQ(map->texels.size(), expected.texels.size());
    // Texels have no padding.
    EXPECT_EQ(std::memcmp(map->texels.data(), expected.texels.data(),
                          sizeof(Texel) * expected.texels.size()),
              0);
    EXPECT_EQ(map->texel_at, expected.texel_at);
  });
}

TEST(Rasterise, StretchOfAKnownMap) {
  // A square metre on 8 x 2 texels: derivatives 1/8 and 1/2; L2 = sqrt((1/64 + 1/4) / 2) * 4.
  scene::Mesh mesh;
  testing::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const scene::Scene scene = testing::scene_of(mesh);
  const Atlas atlas = atlas_of(8, {{{{0, 0}, {8, 0}, {8, 2}}}, {{{0, 0}, {8, 2}, {0, 2}}}});
  const AtlasStats stats = atlas_stats(scene, atlas, rasterise(scene, atlas));
  EXPECT_NEAR(stats.mean_stretch_l2, std::sqrt((1.0 / 64 + 0.25) / 2) * 4, 1e-6);
  EXPECT_DOUBLE_EQ(stats.utilisation, 0.25);
  EXPECT_NEAR(stats.texels_per_metre, 4, 1e-6);
  EXPECT_EQ(stats.owning_triangles, 1);
}

}  // namespace
}  // namespace luxel::atlas
