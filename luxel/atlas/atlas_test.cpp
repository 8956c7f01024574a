#include "luxel/atlas/atlas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "luxel/atlas/atlas_test_support.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::atlas {
namespace {

using ::testing::HasSubstr;

struct Made {
  Atlas atlas;
  TexelMap map;
};

Made make(const scene::Scene& scene, int resolution, UvMode uv = UvMode::unwrap) {
  AtlasParams params;
  params.uv = uv;
  params.resolution = resolution;
  Progress progress;
  Result<Atlas> atlas = make_atlas(scene, params, progress);
  EXPECT_TRUE(atlas) << (atlas ? "" : atlas.error().message);
  if (!atlas) return {};
  TexelMap map = rasterise(scene, *atlas);
  return {std::move(*atlas), std::move(map)};
}

Error error_of(const scene::Scene& scene, const AtlasParams& params) {
  Progress progress;
  const Result<Atlas> atlas = make_atlas(scene, params, progress);
  EXPECT_FALSE(atlas);
  return atlas ? Error{} : atlas.error();
}

/// True where p lies in the triangle, with a margin; by barycentric coordinates.
bool inside(const std::array<Vec2, 3>& t, double x, double y, double margin) {
  const double ax = t[0].x, ay = t[0].y;
  const double bx = t[1].x - ax, by = t[1].y - ay, cx = t[2].x - ax, cy = t[2].y - ay;
  const double area = bx * cy - by * cx;
  if (std::abs(area) < 1e-12) return false;
  const double u = ((x - ax) * cy - (y - ay) * cx) / area;
  const double v = (bx * (y - ay) - by * (x - ax)) / area;
  return u > margin && v > margin && 1 - u - v > margin;
}

uint32_t chart_of_texel(const Made& m, int x, int y) {
  const uint32_t t = m.map.texel_at[size_t(y) * size_t(m.map.resolution) + size_t(x)];
  return t == kNone ? kNone : m.atlas.chart[m.map.texels[t].triangle_number];
}

/// The four texels that a bilinear lookup at p reads belong to `chart` or to nobody.
void expect_lookup_stays(const Made& m, double x, double y, uint32_t chart) {
  const int last = m.map.resolution - 1;
  for (const double dx : {-0.5, 0.5})
    for (const double dy : {-0.5, 0.5}) {
      const int i = std::clamp(int(std::floor(x + dx)), 0, last);
      const int j = std::clamp(int(std::floor(y + dy)), 0, last);
      const uint32_t other = chart_of_texel(m, i, j);
      EXPECT_TRUE(other == chart || other == kNone) << x << " " << y;
    }
}

void expect_sound(const scene::Scene& scene, const Made& m) {
  // No texel centre inside two triangles, by brute force over all texels near each triangle.
  const int n = m.map.resolution;
  std::vector<uint32_t> holder(size_t(n) * size_t(n), kNone);
  RandomStream random{7};
  for (uint32_t t = 0; t < m.atlas.corners.size(); ++t) {
    if (::testing::Test::HasFailure()) return;  // one report is enough
    const auto& c = m.atlas.corners[t];
    const auto [x0, x1] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [y0, y1] = std::minmax({c[0].y, c[1].y, c[2].y});
    ASSERT_GE(std::min(x0, y0), 0);
    ASSERT_LE(std::max(x1, y1), float(n));
    for (int j = int(y0); j < std::min(n, int(y1) + 1); ++j)
      for (int i = int(x0); i < std::min(n, int(x1) + 1); ++i) {
        if (!inside(c, i + 0.5, j + 0.5, 1e-7)) continue;
        uint32_t& other = holder[size_t(j) * size_t(n) + size_t(i)];
        EXPECT_EQ(other, kNone) << "triangles " << other << " and " << t;
        other = t;
        EXPECT_EQ(chart_of_texel(m, i, j), m.atlas.chart[t]) << "centre covered, not owned";
      }
    // Lookups anywhere on the triangle find its own chart.
    for (int k = 0; k < 8; ++k) {
      const Vec2 u = random.next2();
      const double s = std::sqrt(double(u.x)), b = s * (1 - double(u.y)), d = s * double(u.y);
      const double x = c[0].x * (1 - b - d) + c[1].x * b + c[2].x * d;
      const double y = c[0].y * (1 - b - d) + c[1].y * b + c[2].y * d;
      expect_lookup_stays(m, x, y, m.atlas.chart[t]);
      EXPECT_EQ(chart_of_texel(m, std::min(int(x), n - 1), std::min(int(y), n - 1)),
                m.atlas.chart[t]);
    }
  }
  const AtlasStats stats = atlas_stats(scene, m.atlas, m.map);
  EXPECT_EQ(stats.triangles_without_texel, 0u);
  EXPECT_LT(stats.mean_stretch_l2, 1.3);
  EXPECT_GT(stats.mean_stretch_l2, 0.999);
}

TEST(Atlas, IsSoundOnBentFoldedMirroredAndThinThings) {
  const scene::Scene scene = testing::mixed_scene();
  for (const int resolution : {64, 200, 512}) expect_sound(scene, make(scene, resolution));
}

TEST(Atlas, TexelsOfDifferentChartsKeepTheGutter) {
  const Made m = make(testing::mixed_scene(), 128);
  for (const Texel& t : m.map.texels)
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const int x = int(t.x) + dx, y = int(t.y) + dy;
        if (x < 0 || y < 0 || x >= 128 || y >= 128) continue;
        const uint32_t other = chart_of_texel(m, x, y);
        EXPECT_TRUE(other == kNone || other == m.atlas.chart[t.triangle_number]);
      }
}

TEST(Atlas, BoxHasSixChartsOfExactDensity) {
  const scene::Scene scene = testing::scene_of(testing::box({1, 2, 3}));
  const Made m = make(scene, 256);
  EXPECT_EQ(m.atlas.chart_count, 6u);
  const AtlasStats stats = atlas_stats(scene, m.atlas, m.map);
  EXPECT_NEAR(stats.mean_stretch_l2, 1, 1e-3);
  for (uint32_t t = 0; t < 12; ++t) {
    const auto& c = m.atlas.corners[t];
    const double uv = 0.5 * std::abs(cross(c[1] - c[0], c[2] - c[0]));
    const double world = scene::area_m2(scene::world_triangle(scene, 0, t));
    EXPECT_NEAR(std::sqrt(uv / world) / stats.texels_per_metre, 1, 1e-3);
  }
}

TEST(Atlas, DoesNotDependOnTheUnitOfLength) {
  const scene::Scene scene = testing::mixed_scene();
  const Made one = make(scene, 256);
  for (const float scale : {100.0f, 0.01f}) {
    scene::Scene other = scene;
    for (scene::Instance& i : other.instances)
      i.world_from_object = scaling({scale, scale, scale}) * i.world_from_object;
    const Made m = make(other, 256);
    ASSERT_EQ(m.atlas.chart, one.atlas.chart);
    for (size_t t = 0; t < one.atlas.corners.size(); ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_LT(length(m.atlas.corners[t][k] - one.atlas.corners[t][k]), 0.01f) << t;
  }
}

TEST(Atlas, SliversKeepTheirTexelAndLeaveTheOthersAlone) {
  const scene::Scene box = testing::scene_of(testing::box({1, 1, 1}));
  const scene::Scene scene = testing::slivers();
  const Made without = make(box, 128), with = make(scene, 128);
  const double alone = atlas_stats(box, without.atlas, without.map).texels_per_metre;
  const double beside = atlas_stats(scene, with.atlas, with.map).texels_per_metre;
  EXPECT_GT(beside, 0.9 * alone);
  std::set<uint32_t> owners;
  for (const Texel& t : with.map.texels) owners.insert(t.triangle_number);
  EXPECT_EQ(owners.size(), with.atlas.corners.size());
}

TEST(Atlas, InstancesGetPlacesOfTheirOwn) {
  scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  scene.instances.push_back({"two", 0, translation({3, 0, 0})});
  const Made m = make(scene, 128);
  EXPECT_EQ(m.atlas.chart_count, 12u);
  expect_sound(scene, m);
}

TEST(Atlas, DensityFollowsTheWorldNotTheMesh) {
  scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  scene.instances.push_back({"", 0, translation({3, 0, 0}) * scaling({-2, 2, 2})});
  const Made m = make(scene, 256);
  double uv[2] = {0, 0};
  for (uint32_t t = 0; t < 24; ++t) {
    const auto& c = m.atlas.corners[t];
    uv[t / 12] += std::abs(cross(c[1] - c[0], c[2] - c[0]));
  }
  EXPECT_NEAR(uv[1] / uv[0], 4, 0.01);
}

TEST(Atlas, ChartsShowTheFrontSideUnmirrored) {
  const scene::Scene scene = testing::mixed_scene();
  const Made m = make(scene, 512);
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = m.atlas.first_triangle[i]; t < m.atlas.first_triangle[i + 1]; ++t) {
      // Counter-clockwise on the picture is a negative area where y grows downwards.
      const auto& c = m.atlas.corners[t];
      const float area2 = cross(c[1] - c[0], c[2] - c[0]);
      if (determinant(scene.instances[i].world_from_object) < 0)
        EXPECT_GE(area2, 0) << t;
      else
        EXPECT_LE(area2, 0) << t;
    }
}

TEST(Atlas, SingleTriangleInASingleTexel) {
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const scene::Scene scene = testing::scene_of(mesh);
  const Made m = make(scene, 1);
  ASSERT_EQ(m.map.texels.size(), 1u);
  EXPECT_EQ(m.map.texel_at, std::vector<uint32_t>{0});
}

TEST(Atlas, TooSmallStatesAResolutionThatWorks) {
  const scene::Scene scene = testing::mixed_scene();
  AtlasParams params;
  params.uv = UvMode::unwrap;
  params.resolution = 8;
  const std::string message = error_of(scene, params).message;
  const size_t at = message.rfind(' ');
  const int smallest = std::stoi(message.substr(at + 1));
  EXPECT_EQ(smallest & (smallest - 1), 0) << message;
  expect_sound(scene, make(scene, smallest));
  params.resolution = smallest / 2;
  EXPECT_EQ(error_of(scene, params).code, ErrorCode::bad_setting);
}

TEST(Atlas, RefusesSettingsOutOfRange) {
  const scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  for (const int resolution : {0, -3, 16385, 100000}) {
    AtlasParams params;
    params.resolution = resolution;
    EXPECT_EQ(error_of(scene, params).code, ErrorCode::bad_setting);
  }
  AtlasParams params;
  params.texels_per_metre = 1e6f;
  EXPECT_THAT(error_of(scene, params).message, HasSubstr("larger than 16384"));
}

TEST(Atlas, GivenDensityIsMetInTheSmallestPowerOfTwo) {
  const scene::Scene scene = testing::scene_of(testing::box({1, 1, 1}));
  AtlasParams params;
  params.uv = UvMode::unwrap;
  params.texels_per_metre = 20;  // six squares of 20 x 20: 2400 texels, two rows of three
  Progress progress;
  const Result<Atlas> atlas = make_atlas(scene, params, progress);
  ASSERT_TRUE(atlas);
  EXPECT_EQ(atlas->resolution, 64);
  EXPECT_NEAR(atlas_stats(scene, *atlas, rasterise(scene, *atlas)).texels_per_metre, 20, 0.01);
}

TEST(Atlas, SameBitsForAnyNumberOfThreads) {
  const scene::Scene scene = testing::mixed_scene();
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return make(scene, 200);
  };
  const Made one = run(1);
  for (const int threads : {2, 7}) {
    const Made m = run(threads);
    EXPECT_EQ(m.atlas.corners, one.atlas.corners);
    EXPECT_EQ(m.atlas.chart, one.atlas.chart);
    EXPECT_EQ(m.map.texel_at, one.map.texel_at);
    for (size_t t = 0; t < one.map.texels.size(); ++t) {
      EXPECT_EQ(m.map.texels[t].triangle_number, one.map.texels[t].triangle_number);
      EXPECT_EQ(m.map.texels[t].sample.at.u, one.map.texels[t].sample.at.u);
      EXPECT_EQ(m.map.texels[t].sample.at.v, one.map.texels[t].sample.at.v);
    }
  }
}

TEST(Atlas, CanBeCancelled) {
  AtlasParams params;
  params.uv = UvMode::unwrap;
  Progress progress;
  progress.request_cancel();
  const Result<Atlas> atlas = make_atlas(testing::mixed_scene(), params, progress);
  ASSERT_FALSE(atlas);
  EXPECT_EQ(atlas.error().code, ErrorCode::cancelled);
}

// Four times the texels for twice the density, and a 64th for what is not lightmapped.
TEST(Atlas, InstancesHaveTheirOwnDensity) {
  scene::Scene scene;
  scene.materials.emplace_back();
  for (int i = 0; i < 3; ++i) {
    scene::Mesh quad;
    testing::add_quad(quad, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    testing::add_mesh(scene, quad, translation({3 * float(i), 0, 7}));
  }
  scene.instances[1].texel_density = 2;
  scene.instances[2].lightmapped = false;
  const Made made = make(scene, 256);
  double area[3] = {};
  for (size_t t = 0; t < made.atlas.corners.size(); ++t) {
    const auto& c = made.atlas.corners[t];
    area[t / 2] += 0.5 * std::abs(double(cross(c[1] - c[0], c[2] - c[0])));
  }
  // Corners lie on a grid of a fraction of a texel, 10 texels apart at least.
  EXPECT_NEAR(area[1] / area[0], 4, 0.02);
  EXPECT_NEAR(area[2] / area[0], 1.0 / 64, 5e-4);
  // Beside a square of side 1 one of side 2 has two thirds of the page's side at most.
  EXPECT_NEAR(area[1], 4.0 / 9 * 256 * 256, 0.05 * 256 * 256);
}

}  // namespace
}  // namespace luxel::atlas
