#include "luxel/solve/hemicube/mesh.h"

#include <gtest/gtest.h>

#include <map>

#include "luxel/base/vec_double.h"
#include "luxel/scene/grid.h"
#include "luxel/solve/hemicube/hemicube_test_support.h"
#include "luxel/solve/hemicube/weld.h"

namespace luxel::hemicube {
namespace {

using testing::cut_at_random;
using testing::mesh_of;
using testing::scene_of;
using testing::unit_cube;
using testing::unit_square;

TEST(Weld, ACubeHasEightPointsAndAVertexPerFaceAtEach) {
  const Welded w = weld(scene_of(unit_cube()));
  EXPECT_EQ(w.points.size(), 8u);
  EXPECT_EQ(w.vertices.size(), 24u);
  std::vector<int> sides(8);
  for (const uint32_t p : w.point_of) ++sides[p];
  for (const int s : sides) EXPECT_EQ(s, 3);
}

TEST(Weld, AFlatQuadSharesItsDiagonal) {
  const Welded w = weld(scene_of(unit_square()));
  EXPECT_EQ(w.points.size(), 4u);
  EXPECT_EQ(w.vertices.size(), 4u);
}

// Files without an index, or with a vertex per corner, have one place many times, and as -0, too.
TEST(Weld, PlacesAreOneByPositionAlone) {
  scene::Mesh soup;
  soup.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {-0.0f, 0, -0.0f}, {1, 0, 1}, {1, -0.0f, 0}};
  soup.triangles = {{0, 1, 2}, {3, 4, 5}};
  soup.triangle_material = {0, 0};
  const Welded w = weld(scene_of(soup));
  EXPECT_EQ(w.points.size(), 4u);
  EXPECT_EQ(w.vertices.size(), 4u);
}

// An icosahedron cut twice: 10 * 4^2 + 2 corners. With its normals it is round, without a facet has
// vertices of its own.
TEST(Weld, ASphereSharesWhatItsNormalsShare) {
  scene::Scene sphere = scene::inward_sphere(1, 2, {0.5f, 0.5f, 0.5f}, {});
  const Welded facets = weld(sphere);
  EXPECT_EQ(facets.points.size(), 162u);
  EXPECT_EQ(facets.vertices.size(), 3u * 320);
  for (const Vec3& p : sphere.meshes[0].positions) sphere.meshes[0].normals.push_back(-p);
  const Welded round = weld(sphere);
  EXPECT_EQ(round.points.size(), 162u);
  EXPECT_EQ(round.vertices.size(), 162u);
}

// The eight normals of a cube as one round thing lean 54.7 degrees from each of three faces:
// smooth. Those that point up lean 90 degrees from the walls, which then count as flat.
TEST(Weld, NormalsThatLeanFarAwayAreNotSmooth) {
  scene::Scene cube = scene_of(unit_cube());
  for (const Vec3& p : cube.meshes[0].positions)
    cube.meshes[0].normals.push_back(normalize(p - Vec3{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(weld(cube).vertices.size(), 8u);
  cube.meshes[0].normals.assign(8, {0, 1, 0});
  EXPECT_EQ(weld(cube).vertices.size(), 24u);
}

TEST(Weld, MaterialsAndInstancesSplit) {
  scene::Scene square = scene_of(unit_square());
  scene::add_material(square, "other", {0.1f, 0.1f, 0.1f});
  square.meshes[0].triangle_material[1] = 1;
  EXPECT_EQ(weld(square).points.size(), 4u);
  EXPECT_EQ(weld(square).vertices.size(), 6u);
  scene::Scene twice = scene_of(unit_square());
  twice.instances.push_back(twice.instances[0]);
  EXPECT_EQ(weld(twice).points.size(), 8u);
  EXPECT_EQ(weld(twice).vertices.size(), 8u);
}

TEST(Grid, HasTheCountsOfASquareGrid) {
  for (const size_t n : {1, 2, 3, 10, 37}) {
    const float size = 1 / float(n);
    const Mesh square = mesh_of(scene_of(unit_square()), size);
    EXPECT_EQ(square.triangle_count, 2 * n * n);
    EXPECT_EQ(square.points.size(), (n + 1) * (n + 1));
    EXPECT_EQ(square.vertices.size(), (n + 1) * (n + 1));
    const Mesh cube = mesh_of(scene_of(unit_cube()), size);
    EXPECT_EQ(cube.triangle_count, 12 * n * n);
    EXPECT_EQ(cube.points.size(), 6 * n * n + 2);  // Euler: 12 n^2 triangles, 18 n^2 edges
    EXPECT_EQ(cube.vertices.size(), 6 * (n + 1) * (n + 1));
  }
}

/// A triangle of a random sheet: no two edges of one length, angles of all sizes.
scene::Mesh jittered_sheet(int n, uint64_t seed) {
  scene::Mesh mesh;
  RandomStream random{seed};
  const auto jitter = [&] { return 0.6f * (random.next() - 0.5f); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const bool rim = i == 0 || j == 0 || i == n || j == n;
      const float dx = jitter(), dz = jitter();
      mesh.positions.push_back(
          Vec3{float(i) + (rim ? 0 : dx), 0.3f * jitter(), float(j) + (rim ? 0 : dz)} / float(n));
    }
  scene::add_grid_triangles(mesh, n);
  return mesh;
}

/// Meshes of many kinds, cut at random: flat shading and smooth, mirrored and skewed, with creases,
/// with triangles that have no area.
struct Sample {
  std::string name;
  scene::Scene scene;
  Mesh mesh;
};
std::vector<Sample> samples() {
  Mat34 skewed = from_columns({2, 0.3f, 0}, {0, 1, 0.4f}, {0.1f, 0, -3}, {5, 6, 7});
  scene::Mesh with_flat = jittered_sheet(4, 3);
  with_flat.triangles.push_back({0, 5, 5}), with_flat.triangles.push_back({0, 1, 1});
  with_flat.triangle_material.resize(with_flat.triangles.size());
  scene::Scene sphere = scene::inward_sphere(1, 1, {0.5f, 0.5f, 0.5f}, {});
  for (const Vec3& p : sphere.meshes[0].positions) sphere.meshes[0].normals.push_back(-p);
  std::vector<Sample> out;
  out.push_back({"cube", scene_of(unit_cube()), {}});
  out.push_back({"mirrored box", scene_of(unit_cube(), skewed), {}});
  out.push_back({"sheet", scene_of(jittered_sheet(6, 1)), {}});
  out.push_back({"sheet with flat triangles", scene_of(with_flat), {}});
  out.push_back({"sphere", std::move(sphere), {}});
  uint64_t seed = 1;
  std::vector<Sample> grids = out;
  for (Sample& s : out) s.mesh = mesh_of(s.scene), cut_at_random(s.mesh, 700, ++seed);
  for (Sample& s : grids) {
    s.name += ", grid";
    s.mesh = mesh_of(s.scene, 0.21f), cut_at_random(s.mesh, 700, ++seed);
    out.push_back(std::move(s));
  }
  return out;
}

double area_m2(const Mesh& mesh, const Node& n) {
  const DVec3 a = to_double(mesh.points[n.point[0]]);
  return 0.5 * length(cross(to_double(mesh.points[n.point[1]]) - a,
                            to_double(mesh.points[n.point[2]]) - a));
}

TEST(Cuts, PointsVerticesAndNodesAgree) {
  for (const Sample& s : samples()) {
    SCOPED_TRACE(s.name);
    const float near = 2e-6f * scene::world_bounds(s.scene).diagonal();
    EXPECT_EQ(leaves(s.mesh).size(), s.mesh.triangle_count);
    EXPECT_GT(s.mesh.triangle_count, 1000u);
    for (const Node& n : s.mesh.nodes)
      for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(s.mesh.point_of[n.vertex[k]], n.point[k]);
        const Vec3 point = s.mesh.points[n.point[k]];
        EXPECT_LT(length(scene::world_position(s.scene, {n.instance, n.triangle, n.at[k]}) - point),
                  near);
        // A vertex is one of a surface: the place that stands for it lies there, with this normal.
        const scene::SurfacePoint own = s.mesh.vertices[n.vertex[k]];
        EXPECT_LT(length(scene::world_position(s.scene, own) - point), near);
        if (is_flat(s.mesh, n)) continue;
        EXPECT_GT(dot(scene::shading_normal(s.scene, own),
                      scene::shading_normal(s.scene, {n.instance, n.triangle, n.at[k]})),
                  0.998f);
      }
  }
}

TEST(Cuts, CoverTheSurface) {
  for (const Sample& s : samples()) {
    SCOPED_TRACE(s.name);
    std::map<uint32_t, double> covered;
    for (const uint32_t leaf : leaves(s.mesh)) {
      const Node& n = s.mesh.nodes[leaf];
      covered[s.mesh.first_triangle[n.instance] + n.triangle] += area_m2(s.mesh, n);
    }
    const std::vector<uint32_t> first = scene::first_triangles(s.scene);
    for (uint32_t t = 0; t < first[1]; ++t) {
      const double whole = double(scene::area_m2(scene::world_triangle(s.scene, 0, t)));
      EXPECT_NEAR(covered[t], whole, 2e-6 * whole) << t;
    }
  }
}

TEST(Cuts, LocateFindsTheTriangleThatHoldsAPoint) {
  for (const Sample& s : samples()) {
    SCOPED_TRACE(s.name);
    const float near = 2e-6f * scene::world_bounds(s.scene).diagonal();
    RandomStream random{5};
    const auto count = float(scene::first_triangles(s.scene).back());
    for (int i = 0; i < 5000; ++i) {
      Vec2 at = random.next2();
      if (at.x + at.y > 1) at = {1 - at.x, 1 - at.y};
      if (i % 10 == 0) at.x = 0;                 // on an edge
      if (i % 50 == 0) at.y = float(i % 3) / 2;  // at a corner, or the middle of an edge
      const scene::SurfacePoint p{0, uint32_t(random.next() * count), {at.x, at.y}};
      const MeshPoint point = locate(s.mesh, p);
      const Node& n = s.mesh.nodes[point.node];
      ASSERT_EQ(n.child, 0u);
      ASSERT_EQ(n.instance, p.instance);
      ASSERT_EQ(n.triangle, p.triangle);
      ASSERT_GE(std::min({point.at.u, point.at.v, 1 - point.at.u - point.at.v}), -1e-6f);
      const scene::SurfacePoint found = scene_point(n, point.at);
      ASSERT_NEAR(found.at.u, p.at.u, 1e-6);
      ASSERT_NEAR(found.at.v, p.at.v, 1e-6);
      const Vec3 there = interpolate(s.mesh.points[n.point[0]], s.mesh.points[n.point[1]],
                                     s.mesh.points[n.point[2]], point.at);
      ASSERT_LT(length(there - scene::world_position(s.scene, p)), near);
    }
  }
}

using Edge = std::pair<uint32_t, uint32_t>;
/// The number of triangles at each edge, by their points or their vertices.
std::map<Edge, int> edges(const Mesh& mesh, std::array<uint32_t, 3> Node::*corners) {
  std::map<Edge, int> out;
  for (const uint32_t leaf : leaves(mesh)) {
    const Node& n = mesh.nodes[leaf];
    if (is_flat(mesh, n)) continue;
    for (size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax((n.*corners)[k], (n.*corners)[(k + 1) % 3]);
      ++out[{low, high}];
    }
  }
  return out;
}

// A vertex in the middle of another triangle's edge leaves that edge and both of its halves with
// one triangle only. On closed surfaces each edge has two, and Euler's sum is 2.
TEST(Cuts, LeaveNoTVertexOnClosedSurfaces) {
  for (const Sample& s : samples()) {
    if (s.name.starts_with("sheet")) continue;
    SCOPED_TRACE(s.name);
    const auto all = edges(s.mesh, &Node::point);
    for (const auto& [edge, count] : all) EXPECT_EQ(count, 2);
    EXPECT_EQ(int64_t(s.mesh.points.size()) - int64_t(all.size()) + int64_t(s.mesh.triangle_count),
              2);
  }
}

TEST(Cuts, LeaveNoTVertexOnOpenSheets) {
  for (const Sample& s : samples()) {
    if (!s.name.starts_with("sheet")) continue;
    SCOPED_TRACE(s.name);
    double rim_m = 0;
    for (const auto& [edge, count] : edges(s.mesh, &Node::point)) {
      const Vec3 a = s.mesh.points[edge.first], b = s.mesh.points[edge.second];
      EXPECT_LE(count, 2);
      const auto on_rim = [](Vec3 p) { return p.x == 0 || p.z == 0 || p.x == 1 || p.z == 1; };
      if (count != 1) continue;
      EXPECT_TRUE(on_rim(a) && on_rim(b)) << a.x << " " << a.z;
      rim_m += double(std::abs(a.x - b.x) + std::abs(a.z - b.z));
    }
    EXPECT_NEAR(rim_m, 4, 1e-5);
  }
}

// At a crease both sides have the same points and vertices of their own: seen by vertices, the
// twelve edges of a cube are rims, twice, and the inside of each face is whole.
TEST(Cuts, SplitVerticesAtCreasesOnly) {
  for (const Sample& s : samples()) {
    if (!s.name.starts_with("cube")) continue;
    SCOPED_TRACE(s.name);
    double rim_m = 0;
    for (const auto& [edge, count] : edges(s.mesh, &Node::vertex)) {
      EXPECT_LE(count, 2);
      if (count == 1)
        rim_m += double(length(s.mesh.points[s.mesh.point_of[edge.first]] -
                               s.mesh.points[s.mesh.point_of[edge.second]]));
    }
    EXPECT_NEAR(rim_m, 24, 1e-4);
  }
}

double smallest_angle(const Mesh& mesh, const Node& n) {
  double smallest = M_PI;
  for (size_t k = 0; k < 3; ++k) {
    const DVec3 at = to_double(mesh.points[n.point[k]]);
    const DVec3 a = to_double(mesh.points[n.point[(k + 1) % 3]]) - at;
    const DVec3 b = to_double(mesh.points[n.point[(k + 2) % 3]]) - at;
    smallest = std::min(smallest, std::atan2(length(cross(a, b)), dot(a, b)));
  }
  return smallest;
}

// [Rosenberg75]: bisection of the longest edge never makes an angle smaller than half the smallest
// one. A right isosceles triangle stays one.
TEST(Cuts, KeepAnglesWide) {
  for (const Sample& s : samples()) {
    SCOPED_TRACE(s.name);
    std::map<uint32_t, double> before;
    for (const uint32_t root : s.mesh.first_root)
      if (root < s.mesh.nodes.size())
        before[s.mesh.nodes[root].triangle] = smallest_angle(s.mesh, s.mesh.nodes[root]);
    for (const uint32_t leaf : leaves(s.mesh)) {
      const Node& n = s.mesh.nodes[leaf];
      if (is_flat(s.mesh, n)) continue;
      const double least = s.name.starts_with("cube") ? M_PI / 4 : before[n.triangle] / 2;
      EXPECT_GT(smallest_angle(s.mesh, n), least * 0.999);
    }
  }
}

// Triangles end up between the goal's longest edge and a half of it, whatever they were.
TEST(Cuts, ToSizeReachTheGoalAndNotMuchMore) {
  const scene::Scene sheet = scene_of(jittered_sheet(3, 9));
  const float size = 0.03f;
  Mesh mesh = mesh_of(sheet, size);
  const Bisector bisector(mesh);
  double sum = 0;
  for (const uint32_t leaf : leaves(mesh)) {
    const double edge = std::sqrt(bisector.longest_edge2(leaf)) / (std::sqrt(2.0) * double(size));
    EXPECT_LE(edge, 1.1893);
    sum += area_m2(mesh, mesh.nodes[leaf]);
  }
  const double mean = sum / double(mesh.triangle_count);
  EXPECT_GT(mean, 0.25 * double(size * size));  // half of that of the right triangle
  EXPECT_LT(mean, 0.8 * double(size * size));
}

TEST(MakeMesh, RefusesMoreVerticesThanAllowed) {
  Progress progress;
  const scene::Scene scene = scene_of(unit_square());
  EXPECT_TRUE(make_mesh(scene, {.element_size_m = 0.1f, .max_vertices = 121}, progress));
  for (const MeshParams& params : {MeshParams{.element_size_m = 0.1f, .max_vertices = 120},
                                   MeshParams{.element_size_m = 1e-6f, .max_vertices = 1000},
                                   MeshParams{.element_size_m = 0, .max_vertices = 3}}) {
    const auto mesh = make_mesh(scene, params, progress);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, ErrorCode::bad_setting);
  }
}

}  // namespace
}  // namespace luxel::hemicube
