#include "luxel/display/normals_view.h"

#include <gtest/gtest.h>

namespace luxel::display {
namespace {

/// The square of side 2 around the origin, facing +z, seen orthographically from the side: its
/// normals are seen at their full length, the square on edge.
struct NormalsStage {
  scene::Scene scene;
  scene::Camera camera;
  NormalsStage() {
    scene::Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_material = {0, 0};
    scene.meshes = {mesh};
    scene.instances = {{"square", 0, {}}};
    scene.materials = {{}};
    scene.materials[0].double_sided = true;
    camera.world_from_camera = from_columns({0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {5, 0, 0});
    camera.orthographic_height_m = 4;
  }
  image::Image draw() const {
    const auto tracer = trace::RayTracer::build(scene);
    Progress progress;
    const auto picture = draw_normals(scene, *tracer, camera, {200, 200, 1}, progress);
    EXPECT_TRUE(picture);
    return *picture;
  }
};

bool is_red(const image::Image& picture, int x, int y) {
  const Rgb c = picture.rgb(x, y);
  return c.x > 0.3f && c.y < 0.25f * c.x;
}

TEST(NormalsView, LinesStandOnTheCornersAndAreAsLongAsTheyShould) {
  const image::Image picture = NormalsStage().draw();
  // 50 pixels a metre; +z is left. Corners at y = 50 and 150, 4 % of the diagonal are 5.66 pixels.
  int red = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      if (!is_red(picture, x, y)) continue;
      ++red;
      EXPECT_NEAR(std::min(std::abs(y + 0.5 - 50), std::abs(y + 0.5 - 150)), 0, 1.01) << x;
      EXPECT_GT(x + 0.5, 100 - 0.04 * std::sqrt(8) * 50 - 1);
      EXPECT_LT(x + 0.5, 101);
    }
  EXPECT_GE(red, 2 * 5);
}

// A fan around the middle, whose normal is seen from one side and hidden by the square from the
// other.
TEST(NormalsView, LinesBehindASurfaceAreHiddenAndThoseOfUnseenSidesAreNotDrawn) {
  NormalsStage stage;
  scene::Mesh& mesh = stage.scene.meshes[0];
  mesh.positions.push_back({0, 0, 0});
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  mesh.triangle_material = {0, 0, 0, 0};
  const auto red_in_the_middle = [&](const Mat34& view) {
    stage.camera.world_from_camera = view;
    const image::Image picture = stage.draw();
    int red = 0;
    for (int y = 80; y < 120; ++y)
      for (int x = 80; x < 120; ++x) red += is_red(picture, x, y) ? 1 : 0;
    return red;
  };
  const Mat34 front = from_columns({0.8f, 0, -0.6f}, {0, 1, 0}, {0.6f, 0, 0.8f}, {3, 0, 4});
  const Mat34 behind = from_columns({-0.8f, 0, -0.6f}, {0, 1, 0}, {0.6f, 0, -0.8f}, {3, 0, -4});
  EXPECT_GE(red_in_the_middle(front), 3);
  EXPECT_EQ(red_in_the_middle(behind), 0);
  stage.scene.materials[0].double_sided = false;
  EXPECT_EQ(red_in_the_middle(behind), 0);
}

TEST(NormalsView, LinesOfSmallTrianglesAreNoLongerThanTheirEdges) {
  NormalsStage stage;
  scene::Mesh& mesh = stage.scene.meshes[0];
  // A tiny triangle of edge 0.05 in a scene of the same diagonal: 2.5 pixels instead of 5.7.
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 0.5f}, {0.05f, 0, 0.5f}, {0, 0.03f, 0.5f}});
  mesh.triangles.push_back({4, 5, 6});
  mesh.triangle_material.push_back(0);
  const image::Image picture = stage.draw();
  int leftmost = 200;
  for (int y = 90; y < 110; ++y)
    for (int x = 0; x < 200; ++x)
      if (is_red(picture, x, y)) leftmost = std::min(leftmost, x);
  const double edge = std::sqrt(0.05 * 0.05 + 0.03 * 0.03);
  EXPECT_NEAR(leftmost + 0.5, 100 - 50 * (0.5 + edge), 1.01);
}

TEST(NormalsView, ACameraAmongTheCornersIsNoTrouble) {
  NormalsStage stage;
  stage.camera.orthographic_height_m = 0;
  for (const float x : {1.0f, 0.999f, -1.0f}) {
    stage.camera.world_from_camera = translation({x, -1, 0.05f});
    for (const float v : stage.draw().data) EXPECT_TRUE(std::isfinite(v));
  }
}

TEST(NormalsView, StopsWhenCancelled) {
  const NormalsStage stage;
  const auto tracer = trace::RayTracer::build(stage.scene);
  Progress progress;
  progress.request_cancel();
  EXPECT_FALSE(draw_normals(stage.scene, *tracer, stage.camera, {8, 8, 1}, progress));
}

}  // namespace
}  // namespace luxel::display
