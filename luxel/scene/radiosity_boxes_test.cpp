#include <gtest/gtest.h>

#include "luxel/scene/procedural.h"
#include "tests/surfaces.h"

namespace luxel::scene {
namespace {

using namespace testing_support;

// A cube of side 2, closed without gaps although it is made of 14 grids, its front inside.
TEST(RadiosityBox, IsAClosedCubeSeenFromInside) {
  const Scene scene = radiosity_box();
  expect_consistent(scene);
  EXPECT_EQ(scene.instances.size(), 14u);
  const auto triangles = triangles_of(scene);
  EXPECT_EQ(triangles.size(), 6u * 25 * 2);
  expect_closed(triangles);
  EXPECT_NEAR(signed_volume(triangles), -8, 1e-5);
  EXPECT_NEAR(total_area(triangles), 24, 1e-5);
}

TEST(RadiosityBox, LampIsAFifthOfTheCeilingInItsMiddle) {
  const Scene scene = radiosity_box();
  const uint32_t light = instance_named(scene, "light");
  Box3 box;
  double area = 0;
  for (uint32_t t = 0; t < scene.meshes[light].triangles.size(); ++t) {
    const Triangle3 w = world_triangle(scene, light, t);
    area += double(area_m2(w));
    for (const Vec3 p : {w.a, w.b, w.c}) box.extend(p);
    EXPECT_NEAR(front_normal(scene, light, t).y, -1, 1e-6);
    // The paper's lamp, as radiosity.
    const Rgb radiosity = kPi * emission_at(scene, {light, t, {0.3f, 0.3f}});
    EXPECT_NEAR(radiosity.x, 100.4f, 1e-4f);
    EXPECT_NEAR(radiosity.y, 96.8f, 1e-4f);
    EXPECT_NEAR(radiosity.z, 90.0f, 1e-4f);
  }
  EXPECT_NEAR(area, 0.4 * 0.4, 1e-6);
  EXPECT_LT(length(box.centre() - Vec3{0, 2, 0}), 1e-6f);
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    if (i != light) {
      EXPECT_EQ(max_component(emission_at(scene, {i, 0, {}})), 0.0f);
    }
}

// Red on the left of the picture, and no front of a wall between the camera and the room.
TEST(RadiosityBox, CameraLooksThroughTheFrontWall) {
  const Scene scene = radiosity_box();
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Mat34& m = scene.cameras[0].world_from_camera;
  const Vec3 eye = transform_point(m, {});
  const uint32_t front = instance_named(scene, "front wall");
  EXPECT_GT(eye.z, 1);
  EXPECT_LT(dot(front_normal(scene, front, 0), eye - world_position(scene, {front, 0, {}})), 0);
  const uint32_t left = instance_named(scene, "left wall");
  EXPECT_LT(dot(world_position(scene, {left, 0, {}}) - eye, transform_vector(m, {1, 0, 0})), 0);
  EXPECT_GT(reflectance_at(scene, {left, 0, {}}).x, 5 * reflectance_at(scene, {left, 0, {}}).y);
}

TEST(RadiosityBox, ShapesAreClosedSmoothAndOneAboveTheOther) {
  const Scene scene = radiosity_box_with_shapes();
  expect_consistent(scene);
  EXPECT_EQ(scene.instances.size(), 16u);
  Box3 boxes[2];
  size_t vertices = 774;
  for (const bool ring : {false, true}) {
    const uint32_t i = instance_named(scene, ring ? "torus" : "sphere");
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    vertices += mesh.positions.size();
    std::vector<Triangle3> surface;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      surface.push_back(world_triangle(scene, i, t));
      // No facet turns more than its neighbours' angle away from the smooth normal.
      const Vec3 smooth = shading_normal(scene, {i, t, {1 / 3.f, 1 / 3.f}});
      EXPECT_GT(dot(front_normal(scene, i, t), smooth), 0.98f);
      for (const Vec3 p : {surface.back().a, surface.back().b, surface.back().c})
        boxes[ring].extend(p);
    }
    expect_closed(surface);
    const double r = 0.35, R = 0.42, q = 0.13;
    const double expected = ring ? 2 * M_PI * M_PI * R * q * q : 4 * M_PI / 3 * r * r * r;
    EXPECT_LT(signed_volume(surface), expected);
    EXPECT_NEAR(signed_volume(surface), expected, 0.02 * expected);
    EXPECT_EQ(max_component(emission_at(scene, {i, 0, {}})), 0.0f);
  }
  EXPECT_NEAR(double(vertices) / 774, 203.0 / 58, 0.01);
  EXPECT_GT(boxes[0].lower.y, 0.1f);
  EXPECT_GT(boxes[1].lower.y, boxes[0].upper.y);
  EXPECT_LT(boxes[1].upper.y, 1.9f);
}

}  // namespace
}  // namespace luxel::scene
