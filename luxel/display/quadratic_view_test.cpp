#include "luxel/display/quadratic_view.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"

namespace luxel::display {
namespace {

/// The triangle (0, 0), (4, 0), (0, 4) at z = 0 that faces +z, with E = 1 + 2 s + 3 t + 4 s t.
QuadraticMesh one_triangle() {
  QuadraticMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  mesh.triangles = {{0, 1, 2}};
  const auto gray = [](float v) { return Rgb{v, v, v}; };
  mesh.irradiance = {{gray(0), gray(4), gray(2), gray(0), gray(3), gray(1)}};
  mesh.reflectance = {{0.5f, 0.25f, 0}};
  mesh.emission = {{0, 0, 7}};
  mesh.two_sided = {0};
  mesh.background = {9, 9, 9};
  return mesh;
}

scene::Camera above(float z) {
  scene::Camera camera;
  camera.world_from_camera = scene::look_at({2, 2, z}, {2, 2, 0}, {0, 1, 0});
  camera.orthographic_height_m = 4;
  camera.aspect = 1;
  return camera;
}

// Straight from above, pixel (x, y) of 4 x 4 sees the place (x + 0.5, 3.5 - y).
TEST(QuadraticView, ShowsTheFunctionAtEveryPixel) {
  const auto view = QuadraticView::make(one_triangle());
  ASSERT_TRUE(view);
  const image::Image picture = view->draw(above(5), 4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const float s = (float(x) + 0.5f) / 4, t = (3.5f - float(y)) / 4;
      const Rgb c = picture.rgb(x, y);
      if (s + t > 1) {
        EXPECT_EQ(c.x, 9) << x << y;
        EXPECT_EQ(picture.at(x, y)[3], 0);
      } else if (s + t < 1) {
        const float e = 1 + 2 * s + 3 * t + 4 * s * t;
        EXPECT_NEAR(c.x, 0.5f * e / kPi, 1e-5f) << x << y;
        EXPECT_NEAR(c.y, 0.25f * e / kPi, 1e-5f);
        EXPECT_EQ(c.z, 7);
        EXPECT_EQ(picture.at(x, y)[3], 1);
      }
    }
}

TEST(QuadraticView, BacksOfOneSidedTrianglesAreInvisible) {
  QuadraticMesh mesh = one_triangle();
  EXPECT_EQ(QuadraticView::make(mesh)->draw(above(-5), 4, 4).rgb(3, 3).x, 9);
  mesh.two_sided = {1};
  EXPECT_LT(QuadraticView::make(mesh)->draw(above(-5), 4, 4).rgb(3, 3).x, 9);
}

TEST(QuadraticView, RefusesNothing) { EXPECT_FALSE(QuadraticView::make({})); }

}  // namespace
}  // namespace luxel::display
