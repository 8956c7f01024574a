// A picture of a known floor says what must lie under a pointer.
#include "luxel/view/hierarchical/pick.h"

#include "luxel/view/hierarchical/probe_test_support.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;
using testing::lamp;

TEST(Pick, ThePlaceUnderThePointer) {
  const SolutionView view = lamp().view();
  const auto at = face_point_seen(view, testing::camera_above(), {150, 75});
  ASSERT_TRUE(at);
  EXPECT_EQ(at->face, testing::face_of(view, testing::kFloor));
  EXPECT_NEAR(at->position.x, 1, 1e-5);
  EXPECT_NEAR(at->position.z, -0.25, 1e-5);
  // The lamp shows its back to the camera; the screen its front.
  const auto screen = face_point_seen(view, testing::camera_above(), {10, 100});
  ASSERT_TRUE(screen);
  EXPECT_EQ(screen->face, testing::face_of(view, testing::kScreen));
  EXPECT_FALSE(face_point_seen(view, testing::camera_above(), {100, 1e6f}));
}

TEST(Pick, ThePathLeadsFromTheRootToTheLeafThatHoldsThePlace) {
  const SolutionView view = lamp().view();
  const h::Tree& tree = view.solution.tree;
  const h::FacePoint at{testing::face_of(view, testing::kFloor), {0.4, 0, 0.1}};
  const std::vector<uint32_t> path = path_to(view, at);
  ASSERT_GE(path.size(), 3u);
  EXPECT_EQ(path.front(), 0u);
  for (size_t k = 1; k < path.size(); ++k) {
    if (tree.is_cluster(path[k - 1])) {
      const auto& child = tree.clusters[path[k - 1]].child;
      EXPECT_TRUE(child[0] == path[k] || child[1] == path[k]);
      continue;
    }
    EXPECT_EQ(tree.id_of(tree.element(path[k]).parent), path[k - 1]);
  }
  ASSERT_FALSE(tree.is_cluster(path.back()));
  const h::Element& leaf = tree.element(path.back());
  EXPECT_TRUE(leaf.is_leaf());
  EXPECT_EQ(leaf.face, at.face);
  EXPECT_GE(h::depth_inside(leaf.polygon(), {0, 1, 0}, at.position), 0);
}

TEST(Pick, TheTriangleThatHoldsThePlace) {
  const SolutionView view = lamp().view();
  const h::FacePoint at{testing::face_of(view, testing::kFloor), {0.41, 0, 0.13}};
  const auto triangle = triangle_at(view, at);
  ASSERT_TRUE(triangle);
  h::Polygon corners;
  for (const uint32_t v : view.mesh->triangles[*triangle].vertex)
    corners.push_back(view.mesh->vertices[v]);
  EXPECT_GE(h::depth_inside(corners, {0, 1, 0}, at.position), -1e-9);
  SolutionView without = view;
  without.mesh = nullptr;
  EXPECT_FALSE(triangle_at(without, at));
}

TEST(Pick, LinesAreSeenWhereTheirEndsAre) {
  const trace::CameraRays camera = testing::camera_above();
  const auto line = pixels_of(camera, {0.5, 0, 0}, {1, 0, 0.5});
  ASSERT_TRUE(line);
  EXPECT_NEAR((*line)[0].x, 100, 1e-3f);
  EXPECT_NEAR((*line)[1].x, 150, 1e-3f);
  EXPECT_NEAR((*line)[1].y, 150, 1e-3f);
  EXPECT_NEAR(distance_to(*line, {125, 125}), 0, 1e-3f);
  EXPECT_NEAR(distance_to(*line, {150, 100}), std::sqrt(2.0f) * 25, 1e-3f);
  EXPECT_NEAR(distance_to(*line, {150, 160}), 10, 1e-3f);
  // From before the eye to behind it: only the first part is seen, and it leads away from there.
  const auto past = pixels_of(camera, {0.6, 1, 0}, {0.6, 4, 0});
  ASSERT_TRUE(past);
  EXPECT_NEAR((*past)[0].x, 120, 1e-2f);
  EXPECT_GT((*past)[1].x, 1000);
  EXPECT_FALSE(pixels_of(camera, {0.6, 3, 0}, {0.6, 4, 0}));
}

TEST(Pick, TheLinkNearThePointer) {
  const SolutionView view = lamp().view();
  const h::Tree& tree = view.solution.tree;
  const trace::CameraRays camera = testing::camera_above();
  // Any element of the floor with a link to the lamp that the camera sees.
  for (uint32_t id = uint32_t(tree.clusters.size()); id < tree.size(); ++id) {
    const auto& links = view.solution.links.of[id];
    if (links.size() != 1 || tree.element(id).face != testing::face_of(view, testing::kFloor))
      continue;
    const DVec3 from = middle_of(tree, id), to = middle_of(tree, links[0].source);
    if (!(to.y > 2) || std::abs(from.x - 0.5) > 0.8 || std::abs(from.z) > 0.8) continue;
    const auto line = pixels_of(camera, from, from + (to - from) * 0.5);
    ASSERT_TRUE(line);
    EXPECT_EQ(link_near(view, {&id, 1}, near_pixel(camera, (*line)[1])), (LinkNumber{id, 0}));
    const Vec2 along = (*line)[1] - (*line)[0];
    const Vec2 aside = Vec2{-along.y, along.x} * (1 / length(along));
    EXPECT_EQ(link_near(view, {&id, 1}, near_pixel(camera, (*line)[1] + aside * 9.5f)),
              (LinkNumber{id, 0}));
    EXPECT_FALSE(link_near(view, {&id, 1}, near_pixel(camera, (*line)[1] + aside * 10.5f)));
    return;
  }
  FAIL() << "no element with one link to the lamp";
}

TEST(Pick, TheHeaviestOfTheDiscontinuitiesUnderThePointer) {
  const trace::CameraRays camera = testing::camera_above();
  std::vector<h::Discontinuity> lines(3);
  lines[0].a = {0.6, 0, -0.5}, lines[0].b = {0.6, 0, 0.5};  // pixel 110
  lines[1].a = {0.605, 0, -0.5}, lines[1].b = {0.605, 0, 0.5};
  lines[2].a = {0.7, 0, -0.5}, lines[2].b = {0.7, 0, 0.5};  // pixel 120
  const std::vector<double> weight{1, 2, 100};
  EXPECT_EQ(discontinuity_near(lines, weight, near_pixel(camera, {110, 90})), 1u);
  EXPECT_EQ(discontinuity_near(lines, weight, near_pixel(camera, {116, 90})), 2u);
  EXPECT_EQ(discontinuity_near(lines, weight, near_pixel(camera, {129.5f, 90})), 2u);
  EXPECT_EQ(discontinuity_near(lines, weight, near_pixel(camera, {131, 90})), std::nullopt);
  // By a place: 2 cm may lie between.
  EXPECT_EQ(discontinuity_near(lines, weight, near_place({0.715, 0, 0.1}, 0.02)), 2u);
  EXPECT_EQ(discontinuity_near(lines, weight, near_place({0.725, 0, 0.1}, 0.02)), std::nullopt);
}

}  // namespace
}  // namespace luxel::view
