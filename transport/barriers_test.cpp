#include "transport/barriers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "scene/shapes.h"
#include "transport/open_samples.h"

namespace luxel::transport {
namespace {

/// A floor of 2 x 2 m as one chart of 32 x 32 texels (16 per metre), and what stands on it.
struct Floor {
  static constexpr int kSide = 32;
  scene::Scene scene;
  atlas::Atlas atlas;
  atlas::TexelMap map;

  Floor() {
    scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
    scene::add_rectangle(scene, {0, 2, 0, 2}, 0, true, 0);
  }
  void add_box(Vec3 low, Vec3 high, uint32_t material = 0) {
    scene::Mesh box;
    scene::add_box(box, low, high, material);
    scene::place(scene, std::move(box));
  }
  /// Rasterised when all stands; only the floor has a place in the atlas.
  trace::RayTracer tracer() {
    atlas.resolution = kSide;
    atlas.first_triangle = scene::first_triangles(scene);
    atlas.corners.assign(atlas.first_triangle.back(), {Vec2{0, 0}, Vec2{0, 0}, Vec2{0, 0}});
    atlas.chart.assign(atlas.first_triangle.back(), 1);
    atlas.chart_count = 2;
    const scene::Mesh& floor = scene.meshes[0];
    for (uint32_t t = 0; t < 2; ++t) {
      atlas.chart[t] = 0;
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 p = floor.positions[floor.triangles[t][k]];
        atlas.corners[t][k] = {p.x * kSide / 2, p.z * kSide / 2};
      }
    }
    map = atlas::rasterise(scene, atlas);
    std::erase_if(map.texels, [](const atlas::Texel& t) { return t.triangle_number > 1; });
    std::fill(map.texel_at.begin(), map.texel_at.end(), atlas::kNone);
    for (uint32_t i = 0; i < map.texels.size(); ++i)
      map.texel_at[map.texels[i].y * kSide + map.texels[i].x] = i;
    return *trace::RayTracer::build(scene);
  }
  std::vector<atlas::PartedPoints> parted() {
    const trace::RayTracer rays = tracer();
    return find_parted(scene, atlas, map, rays);
  }
};

/// A wall of 1 cm between two columns of samples, from end to end: in each row one pair of
/// neighbours and two of next neighbours, and the plane is one of the wall's sides.
TEST(Barriers, AThinWallPartsEveryRow) {
  Floor floor;
  floor.add_box({0.99f, 0, 0}, {1.0f, 1, 2});  // samples lie at 0.96875 and 1.03125
  const auto parted = floor.parted();
  EXPECT_EQ(parted.size(), 3u * Floor::kSide);
  for (const atlas::PartedPoints& p : parted) {
    EXPECT_LT(p.a.x, 0.99f);
    EXPECT_GT(p.b.x, 1.0f);
    EXPECT_NEAR(std::abs(p.between.normal.x), 1, 1e-6);  // float corners
    EXPECT_NEAR(p.between.height(to_double(Vec3{0.99f, 0, 0})), 0, 1e-6);
  }
}

/// A wall of three texels hides those under it: nothing mixes across.
TEST(Barriers, AThickWallPartsNothing) {
  Floor floor;
  floor.add_box({0.9f, 0, -1}, {1.1f, 1, 3});
  EXPECT_TRUE(floor.parted().empty());
}

/// Light comes over a kerb of a texel's height and through glass.
TEST(Barriers, KerbsAndPanesPartNothing) {
  Floor kerb;
  kerb.add_box({0.99f, 0, 0}, {1.0f, 0.1f, 2});
  EXPECT_TRUE(kerb.parted().empty());
  Floor pane;
  scene::Material glass;
  glass.transmission = 0.5f;
  pane.scene.materials.push_back(glass);
  pane.add_box({0.99f, 0, 0}, {1.0f, 1, 2}, 1);
  EXPECT_TRUE(pane.parted().empty());
}

/// Under the edge of a large box, which crosses a column of texels in their middle, samples that
/// lie inside move out to where the texel is open; deeper ones stay.
TEST(OpenSamples, MoveOutFromUnderABox) {
  Floor floor;
  floor.add_box({1.02f, 0, -1}, {3, 1, 3});  // texels of column 16 span 1 .. 1.0625
  const trace::RayTracer rays = floor.tracer();
  const std::vector<atlas::Texel> before = floor.map.texels;
  const OpenedSamples opened = open_samples(floor.scene, floor.atlas, rays, floor.map);
  EXPECT_EQ(opened.moved.size(), size_t(Floor::kSide));
  for (size_t i = 0; i < before.size(); ++i) {
    const float x = scene::world_position(floor.scene, floor.map.texels[i].sample).x;
    if (before[i].x == 16)
      EXPECT_TRUE(x > 1 && x < 1.02f) << x;
    else
      EXPECT_EQ(x, scene::world_position(floor.scene, before[i].sample).x);
  }
}

/// A large box that stays and a small one that moves: again as from scratch, but only texels around
/// the small one and those that had backs near them are looked at.
TEST(OpenSamples, AgainAreThoseFromScratch) {
  const Box3 there{{0.21f, 0, 0.21f}, {0.49f, 0.3f, 0.49f}};
  const Box3 here{{0.34f, 0, 1.21f}, {0.62f, 0.3f, 1.49f}};
  const auto floor_with = [](const Box3& small) {
    Floor floor;
    floor.add_box({1.02f, 0, -1}, {3, 1, 3});
    floor.add_box(small.lower, small.upper);
    return floor;
  };
  Floor before = floor_with(there), now = floor_with(here), again = floor_with(here);
  const trace::RayTracer rays_before = before.tracer(), rays = now.tracer();
  const trace::RayTracer rays_again = again.tracer();
  const OpenedSamples kept = open_samples(before.scene, before.atlas, rays_before, before.map);
  const OpenedSamples full = open_samples(now.scene, now.atlas, rays, now.map);
  EXPECT_NE(kept.moved, full.moved);
  const std::array boxes{there, here};
  const OpenedSamples opened =
      open_samples_again(again.scene, again.atlas, rays_again, boxes, kept.near_backs, again.map);
  EXPECT_EQ(opened.moved, full.moved);
  EXPECT_EQ(opened.near_backs, full.near_backs);
  for (size_t i = 0; i < now.map.texels.size(); ++i) {
    const Barycentric a = now.map.texels[i].sample.at, b = again.map.texels[i].sample.at;
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.v, b.v);
  }
  // Nothing else is looked at: where it is not said that backs are near, they are not found.
  Floor unsaid = floor_with(here);
  const trace::RayTracer rays_unsaid = unsaid.tracer();
  for (const uint32_t i :
       open_samples_again(unsaid.scene, unsaid.atlas, rays_unsaid, boxes, {}, unsaid.map)
           .near_backs)
    EXPECT_LT(unsaid.map.texels[i].x, 16);
}

}  // namespace
}  // namespace luxel::transport
