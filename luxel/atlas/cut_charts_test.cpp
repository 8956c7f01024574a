#include "luxel/atlas/cut_charts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "luxel/scene/shapes.h"
#include "tests/surfaces.h"

namespace luxel::atlas {
namespace {

Vec2 unit(Vec2 a) { return a * (1 / length(a)); }

/// A floor of 4 x 4 m in two triangles, 16 texels per metre.
struct Floor {
  scene::Scene scene;
  Atlas atlas;
  std::vector<PartedPoints> parted;

  Floor() {
    const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
    scene::add_rectangle(scene, {0, 4, 0, 4}, 0, true, gray);
    atlas.first_triangle = {0, 2};
    atlas.chart = {0, 0}, atlas.chart_count = 1;
  }
  /// Divides it into squares, this many along each side.
  void divide(uint32_t squares) {
    scene::Mesh& mesh = scene.meshes[0];
    mesh.positions.clear(), mesh.normals.clear(), mesh.uv0.clear(), mesh.triangles.clear();
    const float d = 4.0f / float(squares);
    for (uint32_t k = 0; k < squares * squares; ++k) {
      const float x = float(k % squares) * d, z = float(k / squares) * d;
      scene::add_quad(mesh, {Vec3{x, 0, z + d}, {x + d, 0, z + d}, {x + d, 0, z}, {x, 0, z}}, 0);
    }
    mesh.triangle_material.assign(2 * squares * squares, 0);
    atlas.first_triangle = {0, 2 * squares * squares};
    atlas.chart.assign(2 * squares * squares, 0);
  }
  /// A wall through the points (x, z) from a to b: pairs of places a texel apart along it.
  void add_wall(Vec2 a, Vec2 b, float step = 1.0f / 16) {
    const Vec2 along = unit(b - a), across{-along.y, along.x};
    const DVec3 normal{across.x, 0, across.y};
    const double offset = double(dot(across, a));
    for (float s = 0; s < length(b - a); s += step / 3) {
      const Vec2 p = a + along * s - across * (0.5f * step), q = p + across * step;
      parted.push_back({0, {p.x, 0, p.y}, {q.x, 0, q.y}, {normal, offset}});
    }
  }
};

/// The group of the triangle of the cut floor that holds a place.
uint32_t group_at(const CutScene& cut, Vec2 p) {
  const scene::Mesh& mesh = cut.scene.meshes[0];
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vec2, 3> c;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 v = mesh.positions[mesh.triangles[t][k]];
      c[k] = {v.x, v.z};
    }
    const Barycentric at = barycentric_in(c, p);
    if (at.u >= 0 && at.v >= 0 && at.u + at.v <= 1) return cut.group[t];
  }
  ADD_FAILURE() << p.x << " " << p.y << " lies in no triangle";
  return kNone;
}

/// Four walls of a house that stands askew: what is inside is one group, what is outside another.
TEST(CutCharts, AHouseHasAnInsideAndAnOutside) {
  Floor floor;
  const Vec2 corners[4] = {{1, 1.2f}, {2.9f, 0.8f}, {3.2f, 2.6f}, {1.3f, 3.0f}};
  for (int k = 0; k < 4; ++k) floor.add_wall(corners[k], corners[(k + 1) % 4]);
  const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
  EXPECT_EQ(cut.cuts, 4u);
  ASSERT_EQ(cut.group.size(), cut.scene.meshes[0].triangles.size());
  const Vec2 middle{2.1f, 1.9f};
  const uint32_t inside = group_at(cut, middle), outside = group_at(cut, {0.1f, 0.1f});
  EXPECT_NE(inside, outside);
  for (int k = 0; k < 4; ++k)
    for (const float s : {0.02f, 0.3f, 0.6f, 0.98f}) {
      const Vec2 on_wall = corners[k] * (1 - s) + corners[(k + 1) % 4] * s;
      const Vec2 inwards = unit(middle - on_wall) * 0.03f;  // half a texel
      EXPECT_EQ(group_at(cut, on_wall + inwards), inside) << k << " " << s;
      EXPECT_EQ(group_at(cut, on_wall - inwards), outside) << k << " " << s;
    }
  EXPECT_EQ(std::set<uint32_t>(cut.group.begin(), cut.group.end()).size(), 2u);
  // Ten places, of the floor, of the house and where it crosses the floor's diagonal, four of them
  // on the outline: by Euler's formula a triangulation has 2 * 10 - 2 - 4 triangles.
  EXPECT_EQ(cut.scene.meshes[0].triangles.size(), 14u);
}

/// A lawn of 32 x 32 squares and a wall across half of it. Where the wall does not stand the
/// squares stay whole; those within three texels of its ends are cut, too.
TEST(CutCharts, TrianglesFarFromTheWallStayWhole) {
  Floor floor;
  floor.divide(32);
  floor.add_wall({2.06f, 1}, {2.06f, 3});
  const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
  const size_t added = cut.scene.meshes[0].triangles.size() - 2 * 32 * 32;
  // Two triangles in a square, three pieces of each: 16 squares, and at most two at each end.
  EXPECT_GE(added, 16u * 4);
  EXPECT_LE(added, 20u * 4);
  EXPECT_EQ(std::set<uint32_t>(cut.group.begin(), cut.group.end()).size(), 2u);
}

/// Triangles of a quarter of a texel are divided among both sides of the wall as they are.
TEST(CutCharts, TrianglesFinerThanTexelsStayWhole) {
  Floor floor;
  floor.divide(64);
  floor.add_wall({2.03f, 0}, {2.03f, 4}, 0.25f);
  const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
  EXPECT_EQ(cut.cuts, 1u);
  EXPECT_EQ(cut.scene.meshes[0].triangles.size(), 2u * 64 * 64);
  const uint32_t left = group_at(cut, {0.5f, 2.02f}), right = group_at(cut, {3.5f, 2.02f});
  EXPECT_NE(left, right);
  for (float z = 0.02f; z < 4; z += 0.21f) {
    EXPECT_EQ(group_at(cut, {1.96f, z}), left) << z;
    EXPECT_EQ(group_at(cut, {2.1f, z}), right) << z;
  }
}

/// A blade of grass parts the three pairs of a texel. It cuts a floor of two triangles, but not a
/// lawn whose triangles are as large as texels.
TEST(CutCharts, ABladeOfGrassCutsNoFineLawn) {
  for (const bool fine : {false, true}) {
    Floor floor;
    if (fine) floor.divide(64);
    floor.add_wall({2.01f, 1}, {2.01f, 1.0625f});
    const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
    EXPECT_EQ(cut.cuts, fine ? 0u : 1u);
  }
}

/// A lawn beside a path, each a mesh of its own, and a wall across both: of the lawn's chart alone
/// something was said, and the path gets the vertex on their common edge. A step in the file whose
/// corners lie on another edge of the lawn stays as it was.
TEST(CutCharts, NeighboursInOtherMeshesGetTheVertex) {
  Floor floor;
  scene::add_rectangle(floor.scene, {4, 8, 0, 4}, 0, true, 0);  // the path
  scene::add_rectangle(floor.scene, {1, 2, 4, 5}, 0, true, 0);  // the step
  floor.atlas.first_triangle = {0, 2, 4, 6};
  floor.atlas.chart = {0, 0, 1, 1, 2, 2}, floor.atlas.chart_count = 3;
  const size_t before =
      testing_support::count_t_junctions(testing_support::triangles_of(floor.scene));
  EXPECT_EQ(before, 2u);
  floor.add_wall({0, 2.7f}, {4, 2.5f});
  const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
  EXPECT_EQ(testing_support::count_t_junctions(testing_support::triangles_of(cut.scene)), before);
  EXPECT_EQ(cut.scene.meshes[1].triangles.size(), 3u);
  EXPECT_EQ(cut.scene.meshes[2].triangles.size(), 2u);
  EXPECT_EQ(cut.group.size(), scene::first_triangles(cut.scene).back());
}

/// Two pairs leave the floor whole; so does nothing at all.
TEST(CutCharts, ShortBarriersAreLeftAlone) {
  Floor floor;
  EXPECT_EQ(cut_charts(floor.scene, floor.atlas, {}).cuts, 0u);
  floor.add_wall({1, 1}, {1.19f, 1});
  floor.parted.resize(2);
  const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
  EXPECT_EQ(cut.cuts, 0u);
  EXPECT_EQ(cut.scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(cut.group, (std::vector<uint32_t>{0, 0}));
}

/// Two floors of one mesh: only the one under the wall is cut, and gets a mesh of its own.
TEST(CutCharts, OtherInstancesStayWhole) {
  Floor floor;
  scene::Instance other = floor.scene.instances[0];
  other.world_from_object.row[1][3] = 3;
  floor.scene.instances.push_back(other);
  floor.atlas.first_triangle = {0, 2, 4};
  floor.atlas.chart = {0, 0, 1, 1}, floor.atlas.chart_count = 2;
  floor.add_wall({0, 2}, {4, 2.5f});
  const CutScene cut = cut_charts(floor.scene, floor.atlas, floor.parted);
  EXPECT_EQ(cut.cuts, 1u);
  ASSERT_EQ(cut.scene.meshes.size(), 2u);
  EXPECT_EQ(cut.scene.instances[0].mesh, 1u);
  EXPECT_EQ(cut.scene.meshes[0].triangles.size(), 2u);
  EXPECT_GT(cut.scene.meshes[1].triangles.size(), 3u);
  const std::vector<uint32_t> last(cut.group.end() - 2, cut.group.end());
  EXPECT_EQ(last, (std::vector<uint32_t>{0, 0}));
}

}  // namespace
}  // namespace luxel::atlas
