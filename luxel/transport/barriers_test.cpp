#include "luxel/transport/barriers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "luxel/scene/shapes.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/floor_test_support.h"
#include "luxel/transport/visible_samples.h"

namespace luxel::transport {
namespace {

/// A wall of 1 cm between two columns of samples, from end to end: in each row five pairs of
/// neighbouring columns at most two rows apart, but for six that would end beyond the floor. The
/// plane is one of the wall's sides.
TEST(Barriers, AThinWallPartsEveryRow) {
  Floor floor;
  floor.add_box({0.99f, 0, 0}, {1.0f, 1, 2});  // samples lie at 0.96875 and 1.03125
  const auto parted = floor.parted();
  const auto is_next = [](const atlas::PartedPoints& p) { return std::abs(p.a.x - p.b.x) < 0.1f; };
  EXPECT_EQ(std::ranges::count_if(parted, is_next), 5 * Floor::kSide - 6);
  for (const atlas::PartedPoints& p : parted) {
    EXPECT_LT(std::min(p.a.x, p.b.x), 0.99f);
    EXPECT_GT(std::max(p.a.x, p.b.x), 1.0f);
    EXPECT_NEAR(std::abs(p.between.normal.x), 1, 1e-6);  // float corners
    EXPECT_NEAR(p.between.height(to_double(Vec3{p.a.x < 1 ? 0.99f : 1.0f, 0, 0})), 0, 1e-6);
  }
}

/// The search counts each texel twice: for open ways, and for pairs. A cancelled one stops at once.
TEST(Barriers, AreSearchedWithProgress) {
  Floor floor;
  floor.add_box({0.99f, 0, 0}, {1.0f, 1, 2});
  const trace::RayTracer rays = floor.tracer();
  Progress progress;
  EXPECT_FALSE(find_parted(floor.scene, floor.atlas, floor.map, rays, progress)->empty());
  const Progress::Snapshot end = progress.snapshot();
  EXPECT_EQ(end.stage, "walls");
  EXPECT_EQ(end.total, 2 * floor.map.texels.size());
  EXPECT_EQ(end.done, end.total);
  Progress stopped;
  stopped.request_cancel();
  EXPECT_FALSE(find_parted(floor.scene, floor.atlas, floor.map, rays, stopped));
  EXPECT_EQ(stopped.snapshot().done, 0u);
}

/// A wall as above, which ends in the middle of the floor: light comes around its end within three
/// texels, and only pairs farther from it are parted.
TEST(Barriers, EndsPartNothing) {
  Floor floor;
  floor.add_box({0.99f, 0, 0}, {1.0f, 1, 1});
  const auto parted = floor.parted();
  EXPECT_GT(parted.size(), 100u);
  for (const atlas::PartedPoints& p : parted) {
    EXPECT_LT(p.a.z, 1 - 1.0f / 16);
    EXPECT_LT(p.b.z, 1 - 1.0f / 16);
  }
}

/// Nor do the corners of a box: the texel between sees both.
TEST(Barriers, CornersPartNothing) {
  Floor floor;
  floor.add_box({0.7f, 0, 0.7f}, {1.3f, 1, 1.3f});
  EXPECT_TRUE(floor.parted().empty());
}

/// A wall that leans away by 35 degrees from the normal: two texels above the floor it is farther
/// away than the places are apart, and still no light comes over it.
TEST(Barriers, ALeaningWallPartsEveryRow) {
  Floor floor;
  scene::add_material(floor.scene, "sheet", {0.5f, 0.5f, 0.5f});
  floor.scene.materials[1].double_sided = true;
  scene::Mesh wall;
  scene::add_quad(wall, {Vec3{0.99f, 0, 2}, {0.99f, 0, 0}, {1.69f, 1, 0}, {1.69f, 1, 2}}, 1);
  scene::place(floor.scene, std::move(wall));
  EXPECT_GE(floor.parted().size(), 3u * Floor::kSide);
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
  const MappedVector<atlas::Texel> before = floor.map.texels;
  const MovedSamples opened = floor.move_samples(rays);
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
  const MovedSamples opened = floor.move_samples(rays);
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
  const MovedSamples opened = floor.move_samples(rays);
  size_t in_gap = 0;
  for (const uint32_t i : opened.moved) {
    const float x = scene::world_position(floor.scene, floor.map.texels[i].sample).x;
    in_gap += x > from_x && x < to_x;
  }
  return in_gap;
}

/// Half a texel wide, between two columns of samples, which all lie under walls. The texel on the
/// floor's diagonal reaches the slit with its other triangle.
TEST(OpenSamples, MoveIntoASlit) {
  EXPECT_EQ(samples_moved_into_gap(1.05f, 1.08f), 2u * Floor::kSide);
}

/// A texel on the floor's diagonal beside a wall is looked at in its own triangle only.
constexpr size_t kRowsOffDiagonal = Floor::kSide - 1;

/// Three columns of texels: one has its samples under a wall, one beside the other wall, and
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
  const MovedSamples kept = before.move_samples(rays_before);
  const MovedSamples full = now.move_samples(rays);
  EXPECT_NE(kept.moved, full.moved);
  const std::array boxes{there, here};
  const MovedSamples opened = again.move_samples_near(boxes, kept.near_back_faces, rays_again);
  EXPECT_EQ(opened.moved, full.moved);
  EXPECT_EQ(opened.near_back_faces, full.near_back_faces);
  for (size_t i = 0; i < now.map.texels.size(); ++i) {
    const Barycentric a = now.map.texels[i].sample.at, b = again.map.texels[i].sample.at;
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.v, b.v);
  }
  // Nothing else is looked at: where it is not said that backs are near, they are not found.
  Floor unsaid = floor_with(here);
  const trace::RayTracer rays_unsaid = unsaid.tracer();
  for (const uint32_t i : unsaid.move_samples_near(boxes, {}, rays_unsaid).near_back_faces)
    EXPECT_LT(unsaid.map.texels[i].x, 16);
}

/// By another set of rays than move_samples_out_of_solids() takes.
bool in_the_open(const Floor& floor, const trace::RayTracer& rays, Barycentric at,
                 uint32_t triangle) {
  const Vec3 p = scene::world_position(floor.scene, {0, triangle, at});
  return !is_enclosed(floor.scene, rays, p + Vec3{0, 1e-4f, 0}, {0, 1, 0}, 64);
}

/// The backs are farther away than any feeler reaches. A texel of which a quarter or more lies in
/// the open for sure has its sample there.
TEST(OpenSamples, MoveOutFromUnderAShell) {
  Floor floor = floor_under_a_shell();
  const trace::RayTracer rays = floor.tracer();
  const MovedSamples opened = floor.move_samples(rays);
  EXPECT_TRUE(opened.near_back_faces.size() < floor.map.texels.size());
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

}  // namespace
}  // namespace luxel::transport
