#include "luxel/scene/join_pieces.h"

#include <gtest/gtest.h>

#include <numeric>

#include "luxel/scene/cut_mesh.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"
#include "tests/surfaces.h"

namespace luxel::scene {
namespace {

/// A mesh that has been cut along three planes, all of it by the first two and a third of it by the
/// last one.
struct CutShape {
  Scene scene;
  CutTriangles cut;
  uint32_t first_vertex = 0;

  explicit CutShape(Scene whole) : scene(std::move(whole)) {
    Mesh& mesh = scene.meshes[0];
    first_vertex = uint32_t(mesh.positions.size());
    cut.part_of.resize(mesh.triangles.size());
    std::iota(cut.part_of.begin(), cut.part_of.end(), 0u);
    const Vec3 normals[3]{{1, 2, 0.3f}, {-0.7f, 0.2f, 1}, {1, 0.1f, 0}};
    for (int k = 0; k < 3; ++k) {
      std::vector<uint8_t> chosen(mesh.triangles.size());
      for (size_t t = 0; t < chosen.size(); ++t) chosen[t] = k < 2 || t % 3 == 0;
      const Plane plane{normalize(to_double(normals[k])), 0.2};
      for (const uint32_t t : cut_mesh(mesh, chosen, plane, 1e-6))
        cut.part_of.push_back(uint32_t(cut.part_of[t]));
    }
  }
  Mesh& mesh() { return scene.meshes[0]; }
  std::vector<Triangle3> triangles() const { return testing_support::triangles_of(scene); }
};

Scene ball() {
  Scene scene;
  add_material(scene, "clay", {0.5f, 0.5f, 0.5f});
  place(scene, sphere("ball", 1, 16, 9, 0));
  return scene;
}

/// Pieces of one group become what they were, corner by corner and in their order.
TEST(JoinPieces, CutsAreUndone) {
  const Scene whole = ball();
  CutShape shape(whole);
  ASSERT_GT(shape.mesh().triangles.size(), whole.meshes[0].triangles.size() + 100);
  shape.cut.group.assign(shape.mesh().triangles.size(), 3);
  join_pieces(shape.mesh(), shape.cut, shape.first_vertex);
  EXPECT_EQ(shape.mesh().positions, whole.meshes[0].positions);
  ASSERT_EQ(shape.mesh().triangles.size(), whole.meshes[0].triangles.size());
  for (uint32_t t = 0; t < shape.mesh().triangles.size(); ++t) {
    auto is = shape.mesh().triangles[t], was = whole.meshes[0].triangles[t];
    std::ranges::sort(is), std::ranges::sort(was);
    EXPECT_EQ(is, was);
    EXPECT_EQ(shape.cut.part_of[t], t);
  }
}

/// The area of each group stays, the surface closed and every piece a part of its triangle; and
/// some of the cuts go.
TEST(JoinPieces, GroupsStayApart) {
  CutShape shape(ball());
  const Plane border{normalize(DVec3{1, 2, 0.3}), 0.2};  // the first of the cuts
  const auto group_areas = [&] {
    std::array<double, 2> area{};
    for (uint32_t t = 0; t < shape.mesh().triangles.size(); ++t)
      area[shape.cut.group[t]] += double(area_m2(world_triangle(shape.scene, 0, t)));
    return area;
  };
  for (const auto& t : shape.mesh().triangles) {
    double farthest = 0;
    for (const uint32_t v : t)
      if (const double h = border.height(to_double(shape.mesh().positions[v]));
          std::abs(h) > std::abs(farthest))
        farthest = h;
    shape.cut.group.push_back(farthest > 0);
  }
  const auto before = group_areas();
  const size_t junctions = testing_support::count_t_junctions(shape.triangles());
  const size_t pieces = shape.mesh().triangles.size();
  join_pieces(shape.mesh(), shape.cut, shape.first_vertex);
  EXPECT_LT(shape.mesh().triangles.size(), pieces - 50);
  ASSERT_EQ(shape.cut.group.size(), shape.mesh().triangles.size());
  const auto after = group_areas();
  for (size_t g = 0; g < 2; ++g) EXPECT_NEAR(after[g], before[g], 1e-6);  // single precision
  testing_support::expect_closed(shape.triangles());
  EXPECT_LE(testing_support::count_t_junctions(shape.triangles()), junctions);
}

/// Both sides of a sheet are joined alike.
TEST(JoinPieces, SidesStayTied) {
  Scene scene;
  add_material(scene, "leaf", {0.5f, 0.5f, 0.5f});
  add_rectangle(scene, {-1, 1, -1, 1}, 0, true, 0);
  const std::vector<uint8_t> both(2, 1);
  add_backs(scene, 0, both);
  CutShape shape(scene);
  for (const uint32_t t : shape.cut.part_of) shape.cut.group.push_back(t);
  ASSERT_GT(shape.mesh().triangles.size(), 12u);
  join_pieces(shape.mesh(), shape.cut, shape.first_vertex);
  EXPECT_EQ(shape.mesh().triangles.size(), 4u);
  EXPECT_EQ(shape.mesh().other_side, (std::vector<uint32_t>{2, 3, 0, 1}));
}

}  // namespace
}  // namespace luxel::scene
