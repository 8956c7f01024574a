// The meshes of [Rodriguez06, section 5.8], test 1.
#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/scene/procedural.h"
#include "luxel/solve/hemicube/receivers.h"

namespace luxel::hemicube {
namespace {

struct PaperMesh {
  int tessellation_factor;
  size_t vertices, triangles;
};

// "Tessellation factor 20: 774 vertices, 1200 triangles" and so on; 1 unit = 1 cm. The last also
// follows without the paper: six walls of (n + 1)^2 vertices, and 4 n + 8 more because the ceiling
// is cut in three both ways.
TEST(PaperBox, HasThePapersCounts) {
  const scene::Scene box = scene::radiosity_box();
  for (const PaperMesh& paper : {PaperMesh{20, 774, 1200}, PaperMesh{10, 2734, 4800},
                                 PaperMesh{5, 10254, 19200}, PaperMesh{4, 15814, 30000}}) {
    Progress progress;
    const auto mesh = make_mesh(box, {float(paper.tessellation_factor) * 0.01f}, progress);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->triangle_count, paper.triangles);
    EXPECT_EQ(make_receivers(box, *mesh, ElementKind::vertex).size(), paper.vertices);
    EXPECT_EQ(make_receivers(box, *mesh, ElementKind::triangle).size(), paper.triangles);
    const size_t n = 200 / size_t(paper.tessellation_factor);
    EXPECT_EQ(mesh->vertices.size(), 6 * (n + 1) * (n + 1) + 4 * n + 8);
  }
}

// All triangles are the same, right-angled and isosceles: legs as the factor says.
TEST(PaperBox, TrianglesAreHalfQuads) {
  const scene::Scene box = scene::radiosity_box();
  Progress progress;
  const auto mesh = make_mesh(box, {0.2f}, progress);
  ASSERT_TRUE(mesh) << mesh.error().message;
  for (const uint32_t i : leaves(*mesh)) {
    const auto& point = mesh->nodes[i].point;
    const Vec3 a = mesh->points[point[0]], b = mesh->points[point[1]], c = mesh->points[point[2]];
    std::array<float, 3> edges{length(b - a), length(c - b), length(a - c)};
    std::sort(edges.begin(), edges.end());
    EXPECT_NEAR(edges[0], 0.2f, 1e-5f);
    EXPECT_NEAR(edges[1], 0.2f, 1e-5f);
    EXPECT_NEAR(edges[2], 0.2f * std::sqrt(2.0f), 1e-5f);
  }
}

// The shapes' own triangles are below factor 20 already, so they stay.
TEST(PaperBox, ShapesBringItToThreeAndAHalfTimes) {
  const scene::Scene box = scene::radiosity_box_with_shapes();
  Progress progress;
  const auto mesh = make_mesh(box, {0.2f}, progress);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(make_receivers(box, *mesh, ElementKind::vertex).size(), 774u + 738 + 1200);
  EXPECT_EQ(mesh->triangle_count, 1200u + 2 * 32 * 23 + 2 * 1200);
}

}  // namespace
}  // namespace luxel::hemicube
