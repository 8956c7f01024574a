#include "luxel/scene/cut_mesh.h"

#include <gtest/gtest.h>

#include <map>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"

namespace luxel::scene {
namespace {

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += double(area_m2({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]}));
  return sum;
}

/// True: every edge of the mesh has exactly one triangle on each side, by position.
bool is_closed(const Mesh& mesh) {
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> edges;
  const auto point = [&](uint32_t v) {
    return Point{mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
  };
  for (const auto& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) ++edges[{point(t[k]), point(t[(k + 1) % 3])}];
  for (const auto& [edge, count] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    if (count != 1 || other == edges.end() || other->second != 1) return false;
  }
  return true;
}

Plane plane(Vec3 normal, float offset) { return {normalize(to_double(normal)), double(offset)}; }

/// The plane of x + 2 y + 0.3 z cuts all sides of a ball into pieces that lie on one side of it,
/// and the ball stays closed.
TEST(CutMesh, CutsThroughABall) {
  Mesh ball = sphere("ball", 1, 16, 9, 0);
  const double area = area_of(ball);
  const size_t before = ball.triangles.size();
  const Plane cut = plane({1, 2, 0.3f}, 0.2f);
  const std::vector<uint8_t> all(before, 1);
  const std::vector<uint32_t> part_of = cut_mesh(ball, all, cut, 1e-6);
  ASSERT_EQ(ball.triangles.size(), before + part_of.size());
  ASSERT_GT(part_of.size(), 30u);  // a ring of 32 triangles or more, one piece more each at least
  EXPECT_TRUE(is_closed(ball));
  EXPECT_NEAR(area_of(ball), area, 1e-5 * area);  // float positions of new vertices
  for (const auto& t : ball.triangles) {
    bool above = false, below = false;
    for (const uint32_t v : t) {
      const double h = cut.height(to_double(ball.positions[v]));
      above |= h > 1e-5, below |= h < -1e-5;  // vertices are floats
    }
    EXPECT_FALSE(above && below);
  }
}

/// Where only some triangles are chosen, their neighbours are divided at the shared vertices.
TEST(CutMesh, NeighboursStayJoined) {
  Mesh ball = sphere("ball", 1, 16, 9, 0);
  std::vector<uint8_t> some(ball.triangles.size());
  for (size_t t = 0; t < some.size(); t += 5) some[t] = 1;
  const double area = area_of(ball);
  EXPECT_FALSE(cut_mesh(ball, some, plane({1, 2, 0.3f}, 0.2f), 1e-6).empty());
  EXPECT_TRUE(is_closed(ball));
  EXPECT_NEAR(area_of(ball), area, 1e-5 * area);  // float positions of new vertices
}

/// Exporters write -0 beside 0: an edge from either is the same edge.
TEST(CutMesh, TheSignOfZeroDoesNotPartNeighbours) {
  Mesh mesh;
  mesh.positions = {{0, -1, 0},        {1, 0, 0},  {0, 1, 0},
                    {-0.0f, 1, -0.0f}, {-1, 0, 0}, {-0.0f, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}}, mesh.triangle_material = {0, 0};
  const std::vector<uint8_t> first{1, 0};
  EXPECT_EQ(cut_mesh(mesh, first, plane({0, 1, 0}, 0), 1e-6), (std::vector<uint32_t>{0, 1}));
}

/// A function that is linear over a triangle stays the same one.
TEST(CutMesh, AttributesFollow) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  for (const Vec3& p : mesh.positions) {
    mesh.uv0.push_back({0.5f * p.x + p.y, 1 - p.x});
    mesh.uv1.push_back({p.y, p.x + 2});
    mesh.colors.push_back(Rgb{p.x, p.y, p.x + p.y} * 0.1f);
    mesh.alphas.push_back(0.2f * p.y);
  }
  mesh.triangles = {{0, 1, 2}}, mesh.triangle_material = {7};
  const std::vector<uint8_t> all{1};
  const auto part_of = cut_mesh(mesh, all, plane({1, 0.5f, 0}, 1), 1e-6);
  EXPECT_EQ(part_of, (std::vector<uint32_t>{0, 0}));
  EXPECT_EQ(mesh.triangle_material, (std::vector<uint32_t>{7, 7, 7}));
  ASSERT_EQ(mesh.positions.size(), 5u);
  for (size_t v = 3; v < 5; ++v) {
    const Vec3 p = mesh.positions[v];
    EXPECT_NEAR(mesh.uv0[v].x, 0.5f * p.x + p.y, 1e-6f);  // rounding
    EXPECT_NEAR(mesh.uv0[v].y, 1 - p.x, 1e-6f);
    EXPECT_NEAR(mesh.uv1[v].y, p.x + 2, 1e-6f);
    EXPECT_NEAR(mesh.colors[v].z, 0.1f * (p.x + p.y), 1e-6f);
    EXPECT_NEAR(mesh.alphas[v], 0.2f * p.y, 1e-6f);
    EXPECT_EQ(mesh.normals[v], (Vec3{0, 0, 1}));
  }
}

/// A cut twice is a cut once: the first leaves no triangle on both sides of the plane.
TEST(CutMesh, CutsOnce) {
  Mesh ball = sphere("ball", 1, 16, 9, 0);
  const Plane cut = plane({1, 2, 0.3f}, 0.2f);
  const std::vector<uint8_t> all(ball.triangles.size(), 1);
  cut_mesh(ball, all, cut, 1e-6);
  const std::vector<uint8_t> again(ball.triangles.size(), 1);
  EXPECT_TRUE(cut_mesh(ball, again, cut, 1e-6).empty());
}

/// A sheet whose sides are tied together stays one: every piece has its piece behind.
TEST(CutMesh, SidesStayTied) {
  Scene scene;
  add_material(scene, "leaf", {0.5f, 0.5f, 0.5f});
  add_rectangle(scene, {0, 2, 0, 2}, 0, true, 0);  // its cuts have equal diagonals, too
  const std::vector<uint8_t> both(2, 1);
  add_backs(scene, 0, both);
  Mesh& mesh = scene.meshes[0];
  for (const Plane& cut : {plane({1, 0, 0}, 1), plane({1, 0, 0.4f}, 1.1f)}) {
    std::vector<uint8_t> fronts(mesh.triangles.size());
    for (size_t t = 0; t < fronts.size(); ++t) fronts[t] = t % 2 == 0;
    EXPECT_FALSE(cut_mesh(mesh, fronts, cut, 1e-6).empty());
    ASSERT_EQ(mesh.other_side.size(), mesh.triangles.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const uint32_t o = mesh.other_side[t];
      ASSERT_LT(o, mesh.triangles.size());
      EXPECT_EQ(mesh.other_side[o], t);
      for (size_t k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.positions[mesh.triangles[t][k]],
                  mesh.positions[mesh.triangles[o][(3 - k) % 3]]);
    }
  }
}

TEST(CutMesh, PlaneInObjectSpace) {
  const Mat34 m{{{{0, -2, 0, 1}, {3, 0, 0, -2}, {0, 0.5f, 1, 4}}}};
  const Plane world = plane({1, 2, -1}, 0.7f), object = plane_in_object(world, m);
  for (const Vec3 p : {Vec3{1, 2, 3}, Vec3{-4, 0.5f, 2}})
    EXPECT_NEAR(object.height(to_double(p)), world.height(to_double(transform_point(m, p))),
                1e-5);  // transform_point is float
}

}  // namespace
}  // namespace luxel::scene
