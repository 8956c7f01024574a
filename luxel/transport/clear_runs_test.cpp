#include "luxel/transport/clear_runs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/procedural.h"
#include "luxel/transport/floor_test_support.h"

namespace luxel::transport {
namespace {

const Clearance kHalfATexelUp{-1e-5f, 0.5f, 0, false};

/// The texels of a row from column 20 on are clear. They lie in one triangle of the floor.
bool row_is_clear(Floor& floor, uint32_t row, const Clearance& clearance) {
  const trace::RayTracer rays = floor.tracer();
  const uint32_t first = floor.map.texel_at[row * Floor::kSide + 20];
  const TexelRun run = run_from(floor.map, first, Floor::kSide);
  EXPECT_EQ(run.count, 12u);
  return is_clear(floor.scene, floor.atlas, floor.map, rays, run, clearance);
}

TEST(ClearRuns, EndWithTheRowTheTriangleAndTheLimit) {
  Floor floor;
  floor.tracer();
  uint32_t first = 0;
  while (first < floor.map.texels.size()) {
    const TexelRun run = run_from(floor.map, first, 5);
    EXPECT_EQ(run.first, first);
    EXPECT_LE(run.count, 5u);
    const atlas::Texel &begin = floor.map.texels[first],
                       &last = floor.map.texels[first + run.count - 1];
    EXPECT_EQ(last.y, begin.y);
    EXPECT_EQ(last.x, begin.x + run.count - 1);
    EXPECT_EQ(last.triangle_number, begin.triangle_number);
    first += run.count;
  }
}

/// The texels of row 3 cover z from 0.1875 to 0.25; with one texel around them 0.125 to 0.3125.
TEST(ClearRuns, AreNotWhereSomethingStands) {
  Floor empty, beside, on, above, under;
  EXPECT_TRUE(row_is_clear(empty, 3, kHalfATexelUp));
  beside.add_box({1.5f, -0.1f, 0.32f}, {1.6f, 1, 0.4f});
  EXPECT_TRUE(row_is_clear(beside, 3, kHalfATexelUp));
  EXPECT_FALSE(row_is_clear(beside, 3, {-1e-5f, 0.5f, 0.2f, false}));  // 0.2 texels farther
  on.add_box({1.5f, -0.1f, 0.30f}, {1.6f, 1, 0.4f});
  EXPECT_FALSE(row_is_clear(on, 3, kHalfATexelUp));
  above.add_box({1.2f, 0.04f, 0}, {1.6f, 1, 1});  // half a texel is 0.03125 m
  EXPECT_TRUE(row_is_clear(above, 3, kHalfATexelUp));
  EXPECT_FALSE(row_is_clear(above, 3, {-1e-5f, 1, 0, false}));
  under.add_box({1.2f, -1, 0}, {1.6f, -0.01f, 1});
  EXPECT_TRUE(row_is_clear(under, 3, kHalfATexelUp));
  EXPECT_FALSE(row_is_clear(under, 3, {-0.02f, 0.5f, 0, false}));
}

/// Clearance::own_chart decides if other triangles of the run's chart count: here the floor's
/// second.
TEST(ClearRuns, KnowTheirOwnChart) {
  Floor floor;
  EXPECT_TRUE(row_is_clear(floor, 3, kHalfATexelUp));
  EXPECT_FALSE(row_is_clear(floor, 3, {-1e-5f, 0.5f, 40, true}));
  EXPECT_TRUE(row_is_clear(floor, 3, {1e-5f, 0.5f, 40, true}));  // it lies in the same plane
}

/// A large lightmap is mostly far from everything: rays look at few of its texels, and what is
/// found is what all rays find. The floor, turned and away from the origin, with sheets at random.
TEST(ClearRuns, HideNothingFromRays) {
  RandomStream dice{17};
  int clear_runs = 0;
  for (int k = 0; k < 20; ++k) {
    Floor floor;
    scene::Mesh sheet;
    const auto corner = [&] {
      return Vec3{2 * dice.next(), 0.3f * dice.next() - 0.1f, 2 * dice.next()};
    };
    for (int n = 0; n < 3; ++n) {
      const Vec3 a = corner(), b = a + (corner() - a) * 0.2f, c = a + (corner() - a) * 0.2f;
      scene::add_quad(sheet, {a, b, c, c + a - b}, 0);
    }
    scene::place(floor.scene, std::move(sheet));
    const auto frame = frame_around(normalize(corner() - Vec3{1, 0, 1}));
    const Mat34 away = from_columns(frame.to_world({1, 0, 0}), frame.to_world({0, 1, 0}),
                                    frame.to_world({0, 0, 1}), {30, -7, 11});
    for (scene::Instance& instance : floor.scene.instances) instance.world_from_object = away;
    const trace::RayTracer rays = floor.tracer();
    for (uint32_t first = 0; first < floor.map.texels.size();) {
      const TexelRun run = run_from(floor.map, first, 12);
      first += run.count;
      if (!is_clear(floor.scene, floor.atlas, floor.map, rays, run, kHalfATexelUp)) continue;
      ++clear_runs;
      const atlas::Texel& t = floor.map.texels[run.first];
      const FlatPoint p = flat_point(floor.scene, t.sample);
      const Vec3 right = transform_vector(away, {1.0f / 16, 0, 0});
      for (int n = 0; n < 50; ++n) {
        const auto place = [&] {
          return p.position + right * (float(run.count) * dice.next() - 0.5f) +
                 p.normal * (0.5f * dice.next() / 16);
        };
        const Vec3 from = place(), to = place();
        const trace::Hit hit = rays.closest_hit({from, 0, to - from, 1});
        EXPECT_TRUE(!hit.found() || hit.instance == 0);
      }
    }
  }
  EXPECT_GT(clear_runs, 20 * 32);  // a good third of all
}

/// The texels of a map of the Cornell box above which a run does not know that nothing lies.
size_t unclear_texels(const scene::Scene& scene, int resolution) {
  Progress progress;
  atlas::AtlasParams params;
  params.resolution = resolution;
  const auto atlas = atlas::make_atlas(scene, params, progress);
  const atlas::TexelMap map = atlas::rasterise(scene, *atlas);
  const auto rays = trace::RayTracer::build(scene);
  size_t unclear = 0;
  for (uint32_t first = 0; first < map.texels.size();) {
    const TexelRun run = run_from(map, first, uint32_t(map.texels.size()) - first);
    first += run.count;
    if (!is_clear(scene, *atlas, map, *rays, run, {-1e-5f, 1.5f, 0, false})) unclear += run.count;
  }
  return unclear;
}

/// Rays look at the texels where things meet. Those lie along lines: twice the resolution has four
/// times the texels, and twice those.
TEST(ClearRuns, LeaveRaysALineOfTexels) {
  const scene::Scene scene = scene::cornell_box();
  const size_t half = unclear_texels(scene, 1024), whole = unclear_texels(scene, 2048);
  EXPECT_GT(half, 1000u);
  // 2.5, because runs that end at a wall are shorter in the smaller map; all texels would give 4.
  EXPECT_LT(double(whole), 3 * double(half));
}

}  // namespace
}  // namespace luxel::transport
