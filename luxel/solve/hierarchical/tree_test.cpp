#include "luxel/solve/hierarchical/tree.h"

#include "luxel/solve/hierarchical/hierarchical_test_support.h"
#include "luxel/viewfactor/polygon_test_support.h"

namespace luxel::hierarchical {
namespace {

Faces faces_of(const scene::Scene& scene) {
  Progress progress;
  return *make_faces(scene, progress);
}

TEST(Faces, TrianglesOfAPlaneAreOneFace) {
  const Faces faces = faces_of(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}, 4));
  EXPECT_EQ(faces.size(), 6u);
  for (const uint32_t f : faces.face_of_triangle) EXPECT_LT(f, 6u);
  for (const Face& face : faces.faces) {
    EXPECT_EQ(face.corners.size(), 4u);
    EXPECT_NEAR(viewfactor::area_m2(face.corners), 1, 1e-6);
  }
}

TEST(Faces, CurvedTrianglesStayAlone) {
  const scene::Scene scene = scene::spheres_and_cube();
  const Faces faces = faces_of(scene);
  size_t curved = 0;
  for (const Face& face : faces.faces) {
    curved += face.curved;
    if (face.curved) {
      EXPECT_EQ(face.corners.size(), 3u);
    }
  }
  EXPECT_GT(curved, 400u);  // two spheres; the walls and the cube are flat
}

// A pentagon is a quadrilateral and a triangle.
TEST(Tree, RootsFillTheirFace) {
  viewfactor::Dice dice{3};
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  size_t largest = 0;
  for (const Polygon& face : dice.convex_room(12)) {
    testing::add_polygon(scene, "face", face, 0);
    largest = std::max(largest, face.size());
  }
  ASSERT_GT(largest, 5u);
  const Faces faces = faces_of(scene);
  const Tree tree = testing::tree_of(faces);
  for (uint32_t f = 0; f < faces.size(); ++f) {
    double area = 0;
    for (uint32_t r = tree.first_root[f]; r < tree.first_root[f + 1]; ++r)
      area += tree.elements[r].area_m2;
    EXPECT_NEAR(area, viewfactor::area_m2(faces.faces[f].corners), 1e-9);
  }
}

TEST(Tree, ClustersHoldAllRootsOnce) {
  const Faces faces = faces_of(scene::spheres_and_cube());
  const Tree tree = testing::tree_of(faces);
  ASSERT_EQ(tree.clusters.size() + 1, tree.elements.size());
  std::vector<int> seen(tree.size());
  for (const Cluster& c : tree.clusters)
    for (const uint32_t child : c.child) ++seen[child];
  EXPECT_EQ(seen[0], 0);
  for (size_t id = 1; id < seen.size(); ++id) EXPECT_EQ(seen[id], 1) << id;
  for (size_t id = 0; id < tree.clusters.size(); ++id)
    for (const uint32_t child : tree.clusters[id].child) {
      EXPECT_GT(child, id);
      if (tree.is_cluster(child)) continue;
      for (const DVec3& p : tree.element(child).polygon())
        EXPECT_LE(length(p - tree.clusters[id].centre), tree.clusters[id].radius_m + 1e-9);
    }
}

TEST(Tree, PartsAreConvexAndFillTheWhole) {
  viewfactor::Dice dice{5};
  for (int trial = 0; trial < 100; ++trial) {
    Faces faces;
    Face face;
    const Polygon quad = dice.rectangle({}, 1);
    face.corners = trial % 2 ? quad : Polygon{quad[0], quad[1], quad[2]};
    if (trial % 2) face.corners[2] = face.corners[0] + (face.corners[2] - face.corners[0]) * 1.4;
    face.plane = viewfactor::plane_of(face.corners);
    faces.faces.push_back(face);
    Tree tree = testing::tree_of(faces);
    divide(tree, 0);
    for (size_t e = 1; e < 5; ++e) divide(tree, e);
    ASSERT_EQ(tree.elements.size(), 21u);
    double area = 0;
    for (size_t e = 5; e < 21; ++e) {
      const PolygonView p = tree.elements[e].polygon();
      area += tree.elements[e].area_m2;
      for (size_t k = 0; k < p.size(); ++k) {
        const DVec3 turn =
            cross(p[(k + 1) % p.size()] - p[k], p[(k + 2) % p.size()] - p[(k + 1) % p.size()]);
        EXPECT_GT(dot(turn, face.plane.normal), 0);
      }
      EXPECT_EQ(leaf_at(tree, faces, 0, tree.elements[e].centre), e);
    }
    EXPECT_NEAR(area, viewfactor::area_m2(face.corners), 1e-12);
  }
}

// Long ones in a row, so that parts are rounder: 8 x 1 m becomes 2 x 1 m, and then as usual.
TEST(Tree, LongElementsAreDividedAcross) {
  for (const bool upright : {false, true}) {
    Faces faces;
    Face face;
    const double x = upright ? 1 : 8, y = upright ? 8 : 1;
    face.corners = {{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0}};
    face.plane = viewfactor::plane_of(face.corners);
    faces.faces.push_back(face);
    Tree tree = testing::tree_of(faces);
    divide(tree, 0);
    divide(tree, 3);
    double area = 0;
    for (size_t e = 1; e < 5; ++e) {
      const Element& part = tree.elements[e];
      const DVec3 middle{upright ? 0.5 : 2 * double(e) - 1, upright ? 2 * double(e) - 1 : 0.5, 0};
      EXPECT_LT(length(part.centre - middle), 1e-12) << e;
      EXPECT_NEAR(part.area_m2, 2, 1e-12);
      EXPECT_GT(dot(viewfactor::plane_of(part.polygon()).normal, DVec3{0, 0, 1}), 0.999);
      EXPECT_EQ(leaf_at(tree, faces, 0, part.centre + DVec3{0.1, 0.1, 0}), e == 3 ? 7 : e);
      area += part.area_m2;
    }
    EXPECT_NEAR(area, 8, 1e-12);
    for (size_t e = 5; e < 9; ++e)
      EXPECT_NEAR(tree.elements[e].radius_m, std::sqrt(1 + 0.25) / 2, 1e-12);
  }
}

}  // namespace
}  // namespace luxel::hierarchical
