#include "luxel/scene/smooth_normals.h"

#include <gtest/gtest.h>

#include <set>

#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

constexpr float kOneDegree = kPi / 180;
/// Floats of unit size, and an arc cosine of theirs.
constexpr float kRounding = 1e-5f;

/// The unit cube, faces outwards; vertices are shared between faces.
Mesh shared_cube() {
  Mesh mesh;
  mesh.positions = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                    {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  for (const auto& [a, b, c, d] : {std::array<uint32_t, 4>{0, 3, 2, 1},
                                   {4, 5, 6, 7},
                                   {0, 1, 5, 4},
                                   {3, 7, 6, 2},
                                   {0, 4, 7, 3},
                                   {1, 2, 6, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  return mesh;
}

/// A prism over a regular polygon, closed by two fans; `copies` of the vertices of its first edge,
/// as a seam of texture coordinates makes them.
Mesh prism(uint32_t sides, bool seam) {
  Mesh mesh;
  const uint32_t columns = sides + (seam ? 1 : 0);
  for (uint32_t i = 0; i < columns; ++i) {
    const float phi = 2 * kPi * float(i % sides) / float(sides);
    for (const float y : {0.0f, 2.0f}) {
      mesh.positions.push_back({std::cos(phi), y, std::sin(phi)});
      if (seam) mesh.uv0.push_back({float(i) / float(sides), y});
    }
  }
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t j = (i + 1) % columns;
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * j + 1});
    mesh.triangles.push_back({2 * i, 2 * j + 1, 2 * j});
  }
  for (uint32_t i = 1; i + 1 < sides; ++i) {
    mesh.triangles.push_back({0, 2 * i, 2 * i + 2});
    mesh.triangles.push_back({1, 2 * i + 3, 2 * i + 1});
  }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  return mesh;
}

float largest_angle_to_radius(const Mesh& mesh) {
  float largest = 0;
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    largest = std::max(largest, length(mesh.normals[v] - normalize(mesh.positions[v])));
  return largest;
}

// The normals of a finer and finer sphere tend to its radii. The error of angle weights is of
// second order in the width of the triangles: a quarter with each halving, with room for the next
// order.
TEST(SmoothNormals, OfASphereTendToItsRadii) {
  float before = 0;
  for (const int slices : {16, 32, 64}) {
    Mesh mesh = sphere("ball", 2, slices, slices / 2, 0);
    mesh.normals.clear();
    smooth_normals(mesh, 60 * kOneDegree);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    const float error = largest_angle_to_radius(mesh);
    if (slices > 16) {
      EXPECT_LT(error, before / 3) << slices;
    }
    before = error;
  }
  EXPECT_LT(before, 0.005f);
}

TEST(SmoothNormals, LeaveACubeAsItIsBelowItsAngle) {
  Mesh mesh = shared_cube();
  smooth_normals(mesh, 30 * kOneDegree);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(mesh.triangles, shared_cube().triangles);
}

// Three faces meet in each corner at right angles: the mean of their normals is the diagonal,
// although one or two triangles of a face have the corner.
TEST(SmoothNormals, AreWeightedByAngleNotByTriangle) {
  Mesh mesh = shared_cube();
  smooth_normals(mesh, 91 * kOneDegree);
  ASSERT_EQ(mesh.normals.size(), 8u);
  EXPECT_LT(largest_angle_to_radius(mesh), kRounding);
}

// The sides of a prism over a twelve-sided polygon meet at 30 degrees, and its lids at 90.
TEST(SmoothNormals, SplitVerticesWhereTheSurfaceIsCreased) {
  Mesh below = prism(12, false);
  smooth_normals(below, 29.9f * kOneDegree);
  EXPECT_TRUE(below.normals.empty());
  Mesh mesh = prism(12, false);
  for (const Vec3& p : mesh.positions) mesh.alphas.push_back(0.5f + 0.5f * p.x);
  smooth_normals(mesh, 30 * kOneDegree);
  ASSERT_EQ(mesh.positions.size(), 48u) << "one of the side and one of the lid, for each of 24";
  ASSERT_EQ(mesh.normals.size(), 48u);
  ASSERT_EQ(mesh.alphas.size(), 48u);
  for (size_t v = 0; v < 48; ++v) EXPECT_EQ(mesh.alphas[v], 0.5f + 0.5f * mesh.positions[v].x);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const uint32_t v : mesh.triangles[t]) {
      const Vec3 p = mesh.positions[v];
      const Vec3 expected = t < 24 ? Vec3{p.x, 0, p.z} : Vec3{0, p.y - 1, 0};
      EXPECT_LT(length(mesh.normals[v] - expected), kRounding) << t;
    }
}

// Exporters repeat vertices along a seam; it must not show.
TEST(SmoothNormals, CrossSeamsOfTextureCoordinates) {
  Mesh mesh = prism(12, true);
  smooth_normals(mesh, 30 * kOneDegree);
  ASSERT_EQ(mesh.uv0.size(), mesh.positions.size());
  std::set<float> at_seam;
  for (size_t t = 0; t < 24; ++t)
    for (const uint32_t v : mesh.triangles[t]) {
      const Vec3 p = mesh.positions[v];
      EXPECT_LT(length(mesh.normals[v] - Vec3{p.x, 0, p.z}), kRounding) << t;
      if (p.x == 1) at_seam.insert(mesh.uv0[v].x);
    }
  EXPECT_EQ(at_seam, (std::set<float>{0, 1}));
}

/// Two triangles that meet at 10 degrees along the z axis; `extra` more hang on the same edge.
Mesh fold(bool second_turned, int extra) {
  Mesh mesh;
  const float c = std::cos(10 * kOneDegree), s = std::sin(10 * kOneDegree);
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-c, -s, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.triangles.push_back(second_turned ? std::array<uint32_t, 3>{0, 1, 3}
                                         : std::array<uint32_t, 3>{1, 0, 3});
  if (extra) mesh.triangles.push_back({1, 0, 4});
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  return mesh;
}

// Where a third surface ends on an edge, or one side is turned inside out, no two belong together.
TEST(SmoothNormals, KeepEdgesOfOtherThanTwoLikeSidesSharp) {
  Mesh smooth = fold(false, 0), turned = fold(true, 0), third = fold(false, 1);
  for (Mesh* mesh : {&smooth, &turned, &third}) smooth_normals(*mesh, 60 * kOneDegree);
  EXPECT_FALSE(smooth.normals.empty());
  EXPECT_TRUE(turned.normals.empty());
  EXPECT_TRUE(third.normals.empty());
}

// At the first end of the edge both triangles have a right angle; at the other one 45 degrees and
// that of a tenth.
TEST(SmoothNormals, AreWeightedByAreaAsWell) {
  Mesh mesh = fold(false, 0);
  mesh.positions[3] = mesh.positions[3] * 0.1f;
  smooth_normals(mesh, 60 * kOneDegree);
  const float c = std::cos(10 * kOneDegree), s = std::sin(10 * kOneDegree);
  const Vec3 wide{0, 1, 0}, narrow{-s, c, 0};
  EXPECT_LT(length(mesh.normals[0] - normalize(wide * 0.5f + narrow * 0.05f)), kRounding);
  EXPECT_LT(length(mesh.normals[1] -
                   normalize(wide * (0.5f * kPi / 4) + narrow * (0.05f * std::atan(0.1f)))),
            kRounding);
}

TEST(SmoothNormals, FollowGroupsHoweverTheMeshBends) {
  const auto smoothed = [](std::vector<uint32_t> two_per_face) {
    Mesh mesh = shared_cube();
    std::vector<uint32_t> group;
    for (const uint32_t g : two_per_face) group.insert(group.end(), {g, g});
    smooth_normals(mesh, group);
    return mesh;
  };
  EXPECT_LT(largest_angle_to_radius(smoothed({1, 1, 1, 1, 1, 1})), kRounding);
  EXPECT_TRUE(smoothed({0, 0, 0, 0, 0, 0}).normals.empty()) << "off";
  EXPECT_TRUE(smoothed({1, 2, 3, 4, 5, 6}).normals.empty());
  // Only the edge between the faces y = -1 and x = 1 is smooth: 2 of 24 corners share.
  const Mesh two = smoothed({0, 0, 7, 0, 0, 7});
  EXPECT_EQ(two.positions.size(), 22u);
}

TEST(SmoothNormals, OfATriangleWithoutAreaHurtNobody) {
  Mesh mesh = fold(false, 0);
  mesh.triangles.push_back({0, 1, 1});
  mesh.triangle_material.push_back(0);
  smooth_normals(mesh, 60 * kOneDegree);
  const Vec3 mean =
      normalize(Vec3{0, 1, 0} + Vec3{-std::sin(10 * kOneDegree), std::cos(10 * kOneDegree), 0});
  EXPECT_LT(length(mesh.normals[0] - mean), kRounding);
}

TEST(SmoothNormals, LeaveTheNormalsOfAFileAlone) {
  Mesh mesh = sphere("ball", 1, 16, 8, 0);
  const std::vector<Vec3> before = mesh.normals;
  smooth_normals(mesh, kPi);
  EXPECT_EQ(mesh.normals, before);
}

}  // namespace
}  // namespace luxel::scene
