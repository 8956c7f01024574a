#include "transport/barriers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "scene/shapes.h"
#include "transport/backs_seen.h"
#include "transport/open_samples.h"
#include "transport/supersample.h"

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
  /// A box without a bottom.
  void add_shell(Vec3 low, Vec3 high) {
    scene::Mesh box;
    scene::add_box(box, low, high, 0);
    std::erase_if(box.triangles, [&](const std::array<uint32_t, 3>& t) {
      return std::ranges::all_of(t, [&](uint32_t v) { return box.positions[v].y == low.y; });
    });
    box.triangle_material.resize(box.triangles.size());
    scene::place(scene, std::move(box));
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

/// A wall of a centimetre on the samples of a column, between the grid's places.
TEST(OpenSamples, MoveOutOfAThinWall) {
  Floor floor;
  floor.add_box({1.026f, 0, -1}, {1.036f, 1, 3});  // their centre is at 1.03125
  const trace::RayTracer rays = floor.tracer();
  const OpenedSamples opened = open_samples(floor.scene, floor.atlas, rays, floor.map);
  // The texel on the floor's diagonal has its sample elsewhere.
  EXPECT_EQ(opened.moved.size(), size_t(Floor::kSide - 1));
  for (const atlas::Texel& texel : floor.map.texels) {
    const float x = scene::world_position(floor.scene, texel.sample).x;
    EXPECT_FALSE(x > 1.026f && x < 1.036f) << x;
  }
}

/// Two walls from end to end and a gap between them. Returns how many samples were moved into it.
size_t samples_moved_into_gap(float from_x, float to_x) {
  Floor floor;
  floor.add_box({0.1f, 0, -1}, {from_x, 1, 3});
  floor.add_box({to_x, 0, -1}, {1.95f, 1, 3});
  const trace::RayTracer rays = floor.tracer();
  const OpenedSamples opened = open_samples(floor.scene, floor.atlas, rays, floor.map);
  size_t in_gap = 0;
  for (const uint32_t i : opened.moved) {
    const float x = scene::world_position(floor.scene, floor.map.texels[i].sample).x;
    in_gap += x > from_x && x < to_x;
  }
  return in_gap;
}

/// A texel on the floor's diagonal looks at its own triangle alone.
constexpr size_t kRowsOffDiagonal = Floor::kSide - 1;

/// Half a texel wide, between two columns of samples, which all lie under walls. Of the texel on
/// the diagonal in the first the half that is its own does not reach the slit.
TEST(OpenSamples, MoveIntoASlit) {
  EXPECT_EQ(samples_moved_into_gap(1.05f, 1.08f), Floor::kSide + kRowsOffDiagonal);
}

/// Of its three columns of texels one has its samples under a wall, one beside the other wall, and
/// the middle one lies wholly in the alley: those stay. The half of the diagonal's texel in the
/// third does not reach the wall.
TEST(OpenSamples, MoveIntoAnAlley) {
  EXPECT_EQ(samples_moved_into_gap(1.10f, 1.24f), Floor::kSide + kRowsOffDiagonal);
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

const Vec3 kLamp{0.33f, 0.1f, 1};

/// A shell over the floor that stands on nothing, with a lamp that shines in under its edge.
Floor floor_under_a_shell() {
  Floor floor;
  floor.add_shell({0.53f, 0.15f, 0.53f}, {1.47f, 0.6f, 1.47f});
  scene::PunctualLight lamp;
  lamp.position = kLamp;
  floor.scene.lights.push_back(lamp);
  return floor;
}

/// By another set of rays than open_samples() takes.
bool in_the_open(const Floor& floor, const trace::RayTracer& rays, Barycentric at,
                 uint32_t triangle) {
  const Vec3 p = scene::world_position(floor.scene, {0, triangle, at});
  return !is_enclosed(floor.scene, rays, p + Vec3{0, 1e-4f, 0}, {0, 1, 0}, 64, 4);
}

/// The backs are farther away than any feeler reaches. A texel of which a quarter or more lies in
/// the open for sure has its sample there.
TEST(OpenSamples, MoveOutFromUnderAShell) {
  Floor floor = floor_under_a_shell();
  const trace::RayTracer rays = floor.tracer();
  const OpenedSamples opened = open_samples(floor.scene, floor.atlas, rays, floor.map);
  EXPECT_TRUE(opened.near_backs.size() < floor.map.texels.size());
  EXPECT_GT(opened.moved.size(), 20u);
  size_t enclosed = 0, edges = 0;
  for (const atlas::Texel& texel : floor.map.texels) {
    int open = 0;
    for (int k = 0; k < 16; ++k) {
      const Vec2 p{float(texel.x) + (float(k % 4) + 0.5f) / 4,
                   float(texel.y) + (float(k / 4) + 0.5f) / 4};
      open += in_the_open(floor, rays,
                          atlas::barycentric_in(floor.atlas.corners[texel.triangle_number], p),
                          texel.triangle_number);
    }
    if (open == 0) ++enclosed;
    if (open < 4 || open == 16) continue;
    ++edges;
    EXPECT_TRUE(in_the_open(floor, rays, texel.sample.at, texel.triangle_number))
        << texel.x << " " << texel.y;
  }
  EXPECT_GT(enclosed, 50u);
  EXPECT_GT(edges, 20u);
}

/// Direct light is averaged over the judge's points, which leave out those under the shell also
/// where the lamp reaches them.
TEST(OpenSamples, LightIsAveragedOverPlacesInTheOpen) {
  Floor floor = floor_under_a_shell();
  const trace::RayTracer rays = floor.tracer();
  open_samples(floor.scene, floor.atlas, rays, floor.map);
  const Elements elements = elements_from_texels(floor.scene, floor.atlas, floor.map);
  const Lights lights = collect_lights(floor.scene);
  const size_t n = elements.size();
  Progress progress;
  SupersampleParams params;
  params.direct = {8, 1};
  const auto judge = footprints(floor.scene, floor.atlas, floor.map, elements, rays, params.points,
                                params.direct.seed, progress);
  ASSERT_TRUE(judge);
  DirectLight direct;
  direct.irradiance.assign(n, Rgb{1, 1, 1}), direct.variance.resize(n);
  direct.split_variance.resize(n);
  std::vector<uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0);
  ASSERT_TRUE(average_texels(floor.scene, floor.atlas, floor.map, elements, lights, rays, all,
                             params, direct, progress));
  size_t partly = 0;
  for (size_t i = 0; i < n; ++i) {
    const size_t first = judge->first[i], count = judge->first[i + 1] - first;
    if (count < 2 || count == size_t(params.points)) continue;  // 1: its own, maybe inside
    ++partly;
    float sum = 0;
    for (size_t k = first; k < first + count; ++k) {
      const Vec3 from = judge->points.position[k] + Vec3{0, 1e-5f, 0}, to = kLamp - from;
      const trace::Ray ray{from, 0, normalize(to), length(to)};
      std::array<trace::Hit, 1> hit;
      rays.closest_hits(std::span(&ray, 1), hit);
      if (!hit[0].found()) sum += to.y / (length(to) * dot(to, to));
    }
    // Rays start a little above the floor: 1e-5 of the lamp's height.
    EXPECT_NEAR(direct.irradiance[i].x, sum / float(count), 1e-3f * sum / float(count)) << i;
  }
  EXPECT_GT(partly, 20u);
}

}  // namespace
}  // namespace luxel::transport
