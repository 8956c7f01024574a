#include "luxel/atlas/pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "luxel/atlas/atlas_test_support.h"
#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

using ::testing::HasSubstr;

Result<Atlas> try_pages(const scene::Scene& scene, AtlasParams params) {
  Progress progress;
  return make_atlas(scene, params, progress);
}

Atlas make(const scene::Scene& scene, const AtlasParams& params) {
  Result<Atlas> atlas = try_pages(scene, params);
  EXPECT_TRUE(atlas) << (atlas ? "" : atlas.error().message);
  return atlas ? std::move(*atlas) : Atlas{};
}

AtlasParams fixed(int pages, int resolution) {
  return {.uv = UvMode::unwrap, .resolution = resolution, .pages = pages};
}
AtlasParams automatic(int resolution, float texels_per_metre) {
  return {.uv = UvMode::unwrap,
          .resolution = resolution,
          .texels_per_metre = texels_per_metre,
          .page_mode = PageMode::automatic};
}
AtlasParams per_instance(int resolution, float texels_per_metre) {
  AtlasParams params = automatic(resolution, texels_per_metre);
  params.page_mode = PageMode::per_instance;
  return params;
}

/// Boxes of many sizes, each an instance.
scene::Scene boxes(int count) {
  scene::Scene s = testing::scene_of(testing::box({1, 1, 1}));
  for (int k = 1; k < count; ++k)
    s.instances.push_back({"", 0,
                           translation({3.0f * float(k), 0, 0}) *
                               scaling({1 + 0.1f * float(k % 7), 1, 1 + 0.05f * float(k)})});
  return s;
}

bool on_page(const Page& page, double x, double y) {
  return x >= page.x && x <= page.x + page.side && y >= page.y && y <= page.y + page.side;
}

/// Corners and texels lie on their triangle's page; texels of two charts keep the gutter, so a
/// bilinear lookup sees one chart only.
void expect_sound(const scene::Scene& scene, const Atlas& atlas, int gutter = 2) {
  const std::vector<Page> pages = pages_of(atlas);
  for (uint32_t t = 0; t < atlas.corners.size(); ++t)
    for (const Vec2 c : atlas.corners[t])
      ASSERT_TRUE(on_page(pages[page_of(atlas, t)], double(c.x), double(c.y))) << t;
  const TexelMap map = rasterise(scene, atlas);
  for (const Texel& texel : map.texels) {
    const Page& page = pages[page_of(atlas, texel.triangle_number)];
    ASSERT_TRUE(on_page(page, texel.x + 0.5, texel.y + 0.5));
    for (int dy = -gutter; dy <= gutter; ++dy)
      for (int dx = -gutter; dx <= gutter; ++dx) {
        const int x = int(texel.x) + dx, y = int(texel.y) + dy;
        if (std::min(x, y) < 0 || std::max(x, y) >= map.resolution) continue;
        const uint32_t other = map.texel_at[size_t(y) * size_t(map.resolution) + size_t(x)];
        if (other == kNone) continue;
        ASSERT_EQ(atlas.chart[map.texels[other].triangle_number],
                  atlas.chart[texel.triangle_number]);
      }
  }
  EXPECT_EQ(atlas_stats(scene, atlas, map).triangles_without_texel, 0u);
}

/// Texels per metre of each instance, from the areas of its triangles.
std::vector<double> densities(const scene::Scene& scene, const Atlas& atlas) {
  std::vector<double> out;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    double area = 0, texels = 0;
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t) {
      const scene::Triangle3 w = scene::world_triangle(scene, i, t - atlas.first_triangle[i]);
      area += 0.5 * double(length(cross(w.b - w.a, w.c - w.a)));
      const auto& c = atlas.corners[t];
      const Vec2 p = c[1] - c[0], q = c[2] - c[0];
      texels += 0.5 * std::abs(double(p.x) * double(q.y) - double(p.y) * double(q.x));
    }
    out.push_back(std::sqrt(texels / area));
  }
  return out;
}

double density(const scene::Scene& scene, const Atlas& atlas) {
  return atlas_stats(scene, atlas, rasterise(scene, atlas)).texels_per_metre;
}

TEST(ArrangePages, LiesOnAGridWhenAllAreEqual) {
  for (const int count : {1, 4, 9}) {
    const std::vector<int> sides(size_t(count), 64);
    const int across = int(std::lround(std::sqrt(count)));
    EXPECT_EQ(arrange_pages(sides, 2).side, across * 64 + (across - 1) * 2) << count;
  }
}

TEST(ArrangePages, KeepsSidesAndGaps) {
  std::vector<int> sides;
  for (int k = 0; k < 60; ++k) sides.push_back(1 << (k * 7 % 8));
  sides.push_back(100);
  const Arrangement a = arrange_pages(sides, 3);
  double area = 0;
  for (size_t p = 0; p < sides.size(); ++p) {
    EXPECT_EQ(a.pages[p].side, sides[p]);
    area += (sides[p] + 3.0) * (sides[p] + 3.0);
    EXPECT_LE(std::max(a.pages[p].x, a.pages[p].y) + sides[p], a.side);
    for (size_t q = 0; q < p; ++q) {
      const Page &u = a.pages[p], &v = a.pages[q];
      const int apart = std::max(std::max(u.x - v.x - v.side, v.x - u.x - u.side),
                                 std::max(u.y - v.y - v.side, v.y - u.y - u.side));
      EXPECT_GE(apart, 3);
    }
  }
  EXPECT_LT(double(a.side) * a.side, 2 * area);  // 60 squares leave less than half of it empty
}

TEST(AtlasPages, AreSoundInEveryMode) {
  const scene::Scene scene = testing::mixed_scene();
  for (const AtlasParams& params : {fixed(2, 128), fixed(5, 64), automatic(160, 25),
                                    automatic(256, 40), per_instance(128, 0), per_instance(1, 20)})
    expect_sound(scene, make(scene, params));
}

// The area of the texels doubles with the second page. With 240 charts and their gutters on 512 x
// 512, nine tenths filled, a chart's side grows from 29.4 to 42.3 texels: by 1.44, not by 1.41.
TEST(AtlasPages, TwoPagesHoldTwiceTheTexels) {
  const scene::Scene scene = boxes(40);
  const double one = density(scene, make(scene, fixed(1, 512)));
  const Atlas two = make(scene, fixed(2, 512));
  ASSERT_EQ(two.pages.size(), 2u);
  EXPECT_NEAR(density(scene, two) / one, 1.44, 0.05);
  for (const double d : densities(scene, two)) EXPECT_NEAR(d, density(scene, two), 0.01 * d);
}

// Shared out in order: only the instance at the border, and charts that found no room, part.
TEST(AtlasPages, KeepInstancesTogether) {
  const scene::Scene scene = boxes(60);
  const Atlas atlas = make(scene, fixed(3, 128));
  int parted = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    std::set<uint32_t> pages;
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t)
      pages.insert(page_of(atlas, t));
    parted += pages.size() > 1;
  }
  EXPECT_LE(parted, 12);  // of 60; nearly all do when charts go to the first page with room
}

// Six squares of 20 x 20 with their gutters take 6 * 22^2 = 2904 texels: more than one page of 40 x
// 40, which holds no second square beside the first and its gutter in a row of 42, and one of 64 x
// 64 holds all.
TEST(AtlasPages, AutomaticTakesAsManyAsTheDensityNeeds) {
  const scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  const Atlas one = make(scene, automatic(64, 20));
  EXPECT_TRUE(one.pages.empty());
  EXPECT_EQ(one.resolution, 64);
  const Atlas six = make(scene, automatic(40, 20));
  EXPECT_EQ(six.pages.size(), 6u);
  const Atlas two = make(scene, automatic(46, 20));  // four to a page
  EXPECT_EQ(two.pages.size(), 2u);
  for (const Atlas* atlas : {&one, &six, &two}) EXPECT_NEAR(density(scene, *atlas), 20, 0.01);
}

TEST(AtlasPages, AutomaticWithoutADensityTakesMoreOnlyWhereOneDoesNotDo) {
  const scene::Scene scene = testing::mixed_scene();
  EXPECT_TRUE(make(scene, automatic(128, 0)).pages.empty());
  EXPECT_FALSE(try_pages(scene, fixed(1, 8)));
  const Atlas several = make(scene, automatic(8, 0));
  EXPECT_GT(several.pages.size(), 1u);
  EXPECT_FALSE(try_pages(scene, fixed(int(several.pages.size()) - 1, 8)));
  expect_sound(scene, several);
}

TEST(AtlasPages, AnInstanceHasAPageOfItsOwn) {
  const scene::Scene scene = boxes(12);
  for (const AtlasParams& params : {per_instance(128, 0), per_instance(1, 17)}) {
    const Atlas atlas = make(scene, params);
    ASSERT_EQ(atlas.pages.size(), 12u);
    int largest = 0;
    for (uint32_t i = 0; i < 12; ++i) {
      const int side = atlas.pages[i].side;
      EXPECT_EQ(side & (side - 1), 0);
      largest = std::max(largest, side);
      for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t)
        EXPECT_EQ(page_of(atlas, t), i);
    }
    EXPECT_TRUE(largest == 128 || params.texels_per_metre > 0);
    const double wanted =
        params.texels_per_metre > 0 ? double(params.texels_per_metre) : density(scene, atlas);
    for (const double d : densities(scene, atlas)) EXPECT_NEAR(d, wanted, 0.02 * wanted);
  }
}

TEST(AtlasPages, ATriangleLongerThanAPageIsSaidWithAResolutionThatWorks) {
  scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  testing::add_mesh(scene, testing::box({30, 0.5f, 0.5f}), translation({0, 5, 0}));
  scene.instances.back().name = "beam";
  const Result<Atlas> atlas = try_pages(scene, automatic(128, 10));
  ASSERT_FALSE(atlas);
  EXPECT_EQ(atlas.error().code, ErrorCode::bad_setting);
  EXPECT_THAT(atlas.error().message, HasSubstr("'beam'"));
  EXPECT_THAT(atlas.error().message, HasSubstr("raise --resolution to 512"));
  EXPECT_TRUE(try_pages(scene, automatic(512, 10)));
}

TEST(AtlasPages, RefuseWhatContradicts) {
  const scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  const auto message = [&](const AtlasParams& params) {
    const Result<Atlas> atlas = try_pages(scene, params);
    EXPECT_FALSE(atlas);
    EXPECT_EQ(atlas.error().code, ErrorCode::bad_setting);
    return atlas ? "" : atlas.error().message;
  };
  AtlasParams params = fixed(2, 64);
  params.uv = UvMode::keep;
  EXPECT_THAT(message(params), HasSubstr("one page"));
  params = fixed(2, 64);
  params.texels_per_metre = 3;
  EXPECT_THAT(message(params), HasSubstr("already sets their number"));
  EXPECT_THAT(message(fixed(0, 64)), HasSubstr("between 1 and 4096"));
  EXPECT_THAT(message(fixed(4097, 64)), HasSubstr("between 1 and 4096"));
  EXPECT_THAT(message(fixed(5, 16384)), HasSubstr("room for 1"));
  EXPECT_THAT(message(automatic(64, 3000)), HasSubstr("raise --resolution to 4096"));
  EXPECT_THAT(message(automatic(16384, 16000)), HasSubstr("room for 1"));
}

TEST(AtlasPages, SameBitsForAnyNumberOfThreads) {
  const scene::Scene scene = testing::mixed_scene();
  for (const AtlasParams& params : {fixed(3, 64), automatic(160, 25), per_instance(128, 0)}) {
    const Atlas one = [&] {
      const ThreadLimit limit(1);
      return make(scene, params);
    }();
    const ThreadLimit limit(3);
    const Atlas three = make(scene, params);
    EXPECT_EQ(one.corners, three.corners);
    EXPECT_EQ(one.page, three.page);
  }
}

}  // namespace
}  // namespace luxel::atlas
