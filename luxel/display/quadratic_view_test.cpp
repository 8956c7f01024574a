#include "luxel/display/quadratic_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/scene/shapes.h"
#include "luxel/trace/camera_rays.h"

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

/// A cube of 2 m about the origin, its six sides seen from inside: side k faces along -axis k / 2
/// for even k, +axis for odd, and reflects E = 1 + k + the coordinate along the next axis.
QuadraticMesh inside_of_cube() {
  QuadraticMesh mesh;
  for (int k = 0; k < 6; ++k) {
    const int axis = k / 2;
    const float side = k % 2 == 0 ? 1.0f : -1.0f;
    const auto place = [&](float b, float c) {
      std::array<float, 3> p{};
      p[size_t(axis)] = side, p[size_t((axis + 1) % 3)] = b, p[size_t((axis + 2) % 3)] = c;
      return Vec3{p[0], p[1], p[2]};
    };
    const auto first = uint32_t(mesh.vertices.size());
    for (const auto& [b, c] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      mesh.vertices.push_back(place(float(b), float(c)));
    for (std::array<uint32_t, 3> t : {std::array{0u, 2u, 1u}, {0u, 3u, 2u}}) {
      // Linear between the corners: E = F + 2C s + 2E t.
      const auto value = [&](uint32_t v) {
        return 1 + float(k) + (v == 1 || v == 2 ? 1.0f : -1.0f);
      };
      if (side < 0) std::swap(t[1], t[2]);
      const float f = value(t[0]), s = value(t[1]) - f, u = value(t[2]) - f;
      const auto gray = [](float v) { return Rgb{v, v, v}; };
      mesh.irradiance.push_back({gray(0), gray(0), gray(s), gray(0), gray(u), gray(f)});
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      mesh.reflectance.push_back(gray(kPi)), mesh.emission.push_back(gray(0));
      mesh.two_sided.push_back(0);
    }
  }
  return mesh;
}

// Sides reach behind the eye, and edges are shared: every pixel sees the side that its ray comes to
// first, where it does.
TEST(QuadraticView, FromInsideNoPixelFallsBetweenTriangles) {
  const auto view = QuadraticView::make(inside_of_cube());
  ASSERT_TRUE(view);
  scene::Camera camera;
  camera.world_from_camera = scene::look_at({0.2f, -0.1f, 0.3f}, {-0.4f, 0.35f, 1}, {0, 1, 0});
  camera.fov_y_rad = 2.2f;
  constexpr int kWidth = 61, kHeight = 47;
  const image::Image picture = view->draw(camera, kWidth, kHeight);
  const trace::CameraRays rays(camera, kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const trace::Ray ray = rays.through(float(x) + 0.5f, float(y) + 0.5f);
      float t = INFINITY;
      int side = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const float d = ray.direction[axis];
        const float to_side = ((d > 0 ? 1 : -1) - ray.origin[axis]) / d;
        if (to_side < t) t = to_side, side = 2 * axis + (d > 0 ? 0 : 1);
      }
      const Vec3 place = ray.origin + ray.direction * t;
      EXPECT_NEAR(picture.rgb(x, y).x, 1 + float(side) + place[(side / 2 + 1) % 3], 1e-4f)
          << x << " " << y;
      EXPECT_EQ(picture.at(x, y)[3], 1);
    }
}

TEST(QuadraticView, TheNearerTriangleHidesTheOther) {
  QuadraticMesh mesh = one_triangle();
  // A metre nearer to the camera one that is black and shines a little; then one farther away, and
  // one behind the camera.
  for (const float z : {1.0f, -1.0f, 8.0f}) {
    const auto first = uint32_t(mesh.vertices.size());
    for (size_t k = 0; k < 3; ++k) mesh.vertices.push_back(mesh.vertices[k] + Vec3{0, 0, z});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.irradiance.push_back(mesh.irradiance[0]);
    mesh.reflectance.push_back({}), mesh.emission.push_back({0, 0, z == 1 ? 1.0f : 5.0f}),
        mesh.two_sided.push_back(0);
  }
  scene::Camera perspective = above(5);
  perspective.orthographic_height_m = 0, perspective.fov_y_rad = 0.5f;
  for (const scene::Camera& camera : {above(5), perspective}) {
    const Rgb c = QuadraticView::make(mesh)->draw(camera, 4, 4).rgb(1, 2);
    EXPECT_EQ(c.x, 0);
    EXPECT_EQ(c.z, 1);
  }
}

TEST(QuadraticView, RefusesNothing) { EXPECT_FALSE(QuadraticView::make({})); }

}  // namespace
}  // namespace luxel::display
