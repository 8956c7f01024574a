#include "luxel/post/seams.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/post/post_test_support.h"

namespace luxel::post {
namespace {

constexpr int kSheetSide = 24;

TEST(FindSeams, TheCutIsFoundWeldedOrNot) {
  for (const bool welded : {true, false}) {
    const scene::Scene scene = two_squares(0, welded);
    const std::vector<Seam> seams = find_seams(scene, two_charts(kSheetSide));
    ASSERT_EQ(seams.size(), 1u) << welded;
    // The shared edge is x = 0, from y = 0 to 1: in the left chart it is the right border, in the
    // right chart, turned, the upper border. The same end of the edge comes first on both sides.
    const Seam s = seams[0];
    const bool upwards = s.a0.y < s.a1.y;
    const Vec2 a0 = upwards ? s.a0 : s.a1, a1 = upwards ? s.a1 : s.a0;
    const Vec2 b0 = upwards ? s.b0 : s.b1, b1 = upwards ? s.b1 : s.b0;
    EXPECT_EQ(a0, (Vec2{2 + kSheetSide, 2}));
    EXPECT_EQ(a1, (Vec2{2 + kSheetSide, 2 + kSheetSide}));
    EXPECT_EQ(b0, (Vec2{kSheetSide + 6.25f, 2.5f}));
    EXPECT_EQ(b1, (Vec2{2 * kSheetSide + 6.25f, 2.5f}));
  }
}

TEST(FindSeams, CreasesAreLeftAlone) {
  EXPECT_EQ(find_seams(two_squares(0.2f, true), two_charts(kSheetSide)).size(), 0u);
  EXPECT_EQ(find_seams(two_squares(0.05f, true), two_charts(kSheetSide)).size(), 1u);
  EXPECT_EQ(find_seams(two_squares(0.2f, true), two_charts(kSheetSide), 0.3f).size(), 1u);
  EXPECT_EQ(find_seams(two_squares(kPi, true), two_charts(kSheetSide)).size(), 0u);
}

TEST(FindSeams, SmoothNormalsMakeASeamOfACrease) {
  scene::Scene scene = two_squares(0.4f, true);
  const Vec3 middle = normalize(Vec3{-std::sin(0.2f), 0, std::cos(0.2f)});
  scene.meshes[0].normals.assign(8, middle);
  EXPECT_EQ(find_seams(scene, two_charts(kSheetSide)).size(), 1u);
}

TEST(FindSeams, MirroredInstancesToo) {
  scene::Scene scene = two_squares(0, false);
  scene.instances[0].world_from_object = scaling({-2, 1, 1});
  EXPECT_EQ(find_seams(scene, two_charts(kSheetSide)).size(), 1u);
}

TEST(FindSeams, TwoInstancesHaveTheirOwnSeamsAndNoneBetweenThem) {
  scene::Scene scene = two_squares(0, true);
  scene.instances.push_back(scene.instances[0]);
  atlas::Atlas atlas = two_charts(kSheetSide);
  atlas.first_triangle = {0, 4, 8};
  for (int i = 0; i < 4; ++i) {
    auto moved = atlas.corners[size_t(i)];
    for (Vec2& c : moved) c.y += 100;
    atlas.corners.push_back(moved);
  }
  EXPECT_EQ(find_seams(scene, atlas).size(), 2u);
}

TEST(FindSeams, ChartsThatHangTogetherHaveNone) {
  const scene::Scene scene = two_squares(0, true);
  atlas::Atlas atlas = two_charts(kSheetSide);
  for (size_t t = 2; t < 4; ++t)
    for (size_t c = 0; c < 3; ++c) {
      const Vec3 p = scene.meshes[0].positions[scene.meshes[0].triangles[t][c]];
      atlas.corners[t][c] = {2 + kSheetSide * (p.x + 1), 2 + kSheetSide * p.y};
    }
  EXPECT_EQ(find_seams(scene, atlas).size(), 0u);
}

/// The sheet with the left chart at `left` and the right one at `right`, plus relative noise.
struct SeamSheet {
  atlas::TexelMap map = two_chart_map(kSheetSide);
  std::vector<Seam> seams = find_seams(two_squares(0, true), two_charts(kSheetSide));
  std::vector<Rgb> values;

  SeamSheet(Rgb left, Rgb right, float noise) {
    RandomStream random{9};
    for (const atlas::Texel& t : map.texels)
      values.push_back((t.triangle_number == 0 ? left : right) *
                       (1 + noise * (random.next() - 0.5f)));
  }
  double residual() const { return seam_residual(map, seams, values).rms_over_mean; }
  void stitch() {
    Progress progress;
    const Status status = stitch_seams(map, seams, {}, values, progress);
    EXPECT_TRUE(status);
  }
};

TEST(SeamResidual, IsTheJumpOverTheMean) {
  // Left 1, right 3: the difference is 2 everywhere, the mean 2.
  const SeamSheet sheet({1, 1, 1}, {3, 3, 3}, 0);
  EXPECT_NEAR(sheet.residual(), 1.0, 1e-6);
  EXPECT_EQ(SeamSheet({2, 2, 2}, {2, 2, 2}, 0).residual(), 0.0);
}

TEST(StitchSeams, AJumpAcrossTheCutCloses) {
  for (const float noise : {0.0f, 0.2f}) {
    SeamSheet sheet({1, 2, 0.5f}, {3, 1, 0.6f}, noise);
    const double before = sheet.residual();
    sheet.stitch();
    EXPECT_LT(sheet.residual(), before / 50) << noise;
  }
}

TEST(StitchSeams, OnlyTexelsUnderTheSeamMove) {
  SeamSheet sheet({1, 2, 0.5f}, {3, 1, 0.6f}, 0.2f);
  const std::vector<Rgb> before = sheet.values;
  sheet.stitch();
  int moved = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    const atlas::Texel& t = sheet.map.texels[i];
    // The seam: x = kSheetSide + 2 on the left (a texel border), y = 2.5 on the right (a texel
    // centre).
    const bool may_move = t.triangle_number == 0 ? t.x == kSheetSide + 1 : t.y == 2;
    if (!may_move) {
      EXPECT_EQ(sheet.values[i], before[i]) << t.x << " " << t.y;
    } else if (sheet.values[i] != before[i]) {
      ++moved;
    }
  }
  EXPECT_GT(moved, 2 * kSheetSide - 2);
}

TEST(StitchSeams, WhatOneSideGainsTheOtherLoses) {
  SeamSheet sheet({1, 1, 1}, {3, 3, 3}, 0);
  sheet.stitch();
  const uint32_t middle =
      sheet.map
          .texel_at[size_t((2 + kSheetSide / 2) * sheet.map.resolution) + size_t(kSheetSide + 1)];
  EXPECT_NEAR(sheet.values[middle].x, 2.0f, 0.02f);
}

// Two parts of a sheet change by what together the whole changes by; neither alone is stitched:
// each part's jump weighs as much as the whole's light says. The conjugate gradient ends when the
// residual has fallen to 1e-5 of what it was; the change itself, of the order of 1 here, is known
// to some tens of that: values that move together keep but a small weight, so that the system is
// ill conditioned.
TEST(StitchLayers, PartsChangeAsTheirSumDoes) {
  SeamSheet sheet({1, 2, 0.5f}, {3, 1, 0.6f}, 0.2f);
  const std::vector<Rgb> before = sheet.values;
  std::vector<std::vector<Rgb>> parts(2, std::vector<Rgb>(before.size()));
  for (size_t i = 0; i < before.size(); ++i) {
    const float share = sheet.map.texels[i].triangle_number == 0 ? 0.25f : 0.75f;
    parts[0][i] = before[i] * share, parts[1][i] = before[i] * (1 - share);
  }
  Progress progress;
  ASSERT_TRUE(stitch_layers(sheet.map, sheet.seams, {}, before, parts, progress));
  sheet.stitch();
  for (size_t i = 0; i < before.size(); ++i) {
    const Rgb sum = parts[0][i] + parts[1][i];
    EXPECT_NEAR(sum.x, sheet.values[i].x, 1e-3f);
    EXPECT_NEAR(sum.y, sheet.values[i].y, 1e-3f);
    EXPECT_NEAR(sum.z, sheet.values[i].z, 1e-3f);
  }
}

TEST(StitchSeams, AConstantFieldStaysBitForBit) {
  SeamSheet sheet({0.3f, 0.7f, 1.1f}, {0.3f, 0.7f, 1.1f}, 0);
  const std::vector<Rgb> before = sheet.values;
  sheet.stitch();
  EXPECT_EQ(sheet.values, before);
}

TEST(StitchSeams, DoesNotDependOnTheUnitOfLight) {
  SeamSheet sheet({1, 2, 0.5f}, {3, 1, 0.6f}, 0.2f), brighter = sheet;
  for (Rgb& v : brighter.values) v *= 1024;
  sheet.stitch(), brighter.stitch();
  for (size_t i = 0; i < sheet.values.size(); ++i)
    EXPECT_NEAR(brighter.values[i].x / 1024, sheet.values[i].x, 1e-5f);
}

TEST(StitchSeams, ABrightTexelDoesNotBleedAlongTheSeam) {
  SeamSheet sheet({1, 1, 1}, {1, 1, 1}, 0);
  const auto at = [&](int x, int y) {
    return sheet.map.texel_at[size_t(y * sheet.map.resolution + x)];
  };
  const int y = 2 + kSheetSide / 2;
  sheet.values[at(kSheetSide + 1, y)] = {1000, 1000, 1000};
  sheet.stitch();
  EXPECT_LT(sheet.values[at(kSheetSide + 1, y + 4)].x, 1.5f);
  EXPECT_LT(sheet.values[at(kSheetSide + 1, y - 4)].x, 1.5f);
  EXPECT_GT(sheet.values[at(kSheetSide + 1, y - 4)].x, 0.5f);
}

TEST(StitchSeams, StaysNonNegativeAndFiniteOverAHugeRange) {
  SeamSheet sheet({1, 1, 1}, {1, 1, 1}, 0);
  RandomStream random{11};
  for (Rgb& v : sheet.values) {
    const float e = std::pow(10.0f, 12 * random.next() - 6);
    v = random.next() < 0.3f ? Rgb{} : Rgb{e, 0, 2 * e};
  }
  sheet.stitch();
  for (const Rgb& v : sheet.values) {
    EXPECT_TRUE(is_finite(v));
    EXPECT_GE(min_component(v), 0);
    EXPECT_EQ(v.y, 0);
  }
}

TEST(StitchSeams, BlackStaysBlack) {
  SeamSheet sheet({}, {}, 0);
  sheet.stitch();
  for (const Rgb& v : sheet.values) EXPECT_EQ(v, Rgb{});
}

// Light ends at a seam where a closed room does: the dark side is to stay dark to the bit.
TEST(StitchSeams, ABlackSideStaysBlack) {
  SeamSheet sheet({1, 2, 0.5f}, {}, 0.2f);
  const std::vector<Rgb> before = sheet.values;
  sheet.stitch();
  EXPECT_EQ(sheet.values, before);
}

// A hidden texel neither changes nor counts: the others close the jump as if it was not there.
TEST(StitchSeams, HiddenTexelsTieNothing) {
  SeamSheet sheet({1, 1, 1}, {3, 3, 3}, 0);
  const uint32_t texel =
      sheet.map
          .texel_at[size_t((2 + kSheetSide / 2) * sheet.map.resolution) + size_t(kSheetSide + 1)];
  std::vector<uint8_t> hidden(sheet.values.size());
  hidden[texel] = 1, sheet.values[texel] = {1000, 1000, 1000};
  Progress progress;
  ASSERT_TRUE(stitch_seams(sheet.map, sheet.seams, {.texels = {hidden}}, sheet.values, progress));
  EXPECT_EQ(sheet.values[texel].x, 1000);
  for (size_t i = 0; i < sheet.values.size(); ++i)
    EXPECT_LE(sheet.values[i].x, i == texel ? 1000 : 3.01f);
  EXPECT_LT(seam_residual(sheet.map, sheet.seams, sheet.values, {hidden}).rms_over_mean, 0.02);
}

// One texel beyond a wall keeps its light and gives none: the points that read it do not count.
TEST(StitchSeams, PointsOfTwoRegionsTieNothing) {
  SeamSheet sheet({1, 1, 1}, {3, 3, 3}, 0);
  const uint32_t texel =
      sheet.map
          .texel_at[size_t((2 + kSheetSide / 2) * sheet.map.resolution) + size_t(kSheetSide + 1)];
  std::vector<uint32_t> region(sheet.values.size());
  region[texel] = texel, sheet.values[texel] = {1000, 1000, 1000};
  Progress progress;
  const SeamTexels texels{.region = region};
  ASSERT_TRUE(stitch_seams(sheet.map, sheet.seams, {.texels = texels}, sheet.values, progress));
  EXPECT_EQ(sheet.values[texel].x, 1000);
  for (size_t i = 0; i < sheet.values.size(); ++i)
    EXPECT_LE(sheet.values[i].x, i == texel ? 1000 : 3.01f);
  EXPECT_LT(seam_residual(sheet.map, sheet.seams, sheet.values, texels).rms_over_mean, 0.02);
}

TEST(StitchSeams, SameBitsForAnyThreadCount) {
  SeamSheet one({1, 2, 0.5f}, {3, 1, 0.6f}, 0.5f), seven = one;
  {
    const ThreadLimit limit(1);
    one.stitch();
  }
  {
    const ThreadLimit limit(7);
    seven.stitch();
  }
  EXPECT_EQ(one.values, seven.values);
}

TEST(StitchSeams, StopsWhenCancelled) {
  SeamSheet sheet({1, 1, 1}, {3, 3, 3}, 0);
  Progress progress;
  progress.request_cancel();
  const Status status = stitch_seams(sheet.map, sheet.seams, {}, sheet.values, progress);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::post
