#include "luxel/pipeline/bake/ground.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

/// A fence along x, `length_m` long and 2 m high, under an even sky.
scene::Scene fence(float length_m) {
  scene::Scene scene;
  scene.background = {1, 2, 3};
  scene.materials.emplace_back();
  scene.materials[0].double_sided = true;
  const float x = length_m / 2;
  scene::Mesh mesh;
  scene::add_quad(mesh, {{{-x, 1, 0}, {x, 1, 0}, {x, 3, 0}, {-x, 3, 0}}}, 0);
  scene::place(scene, std::move(mesh));
  return scene;
}

scene::Camera camera_at(Vec3 eye, Vec3 target) {
  scene::Camera camera;
  camera.world_from_camera = scene::look_at(eye, target, {0, 1, 0});
  return camera;
}
const scene::Camera kFromAbove = camera_at({5, 8, 9}, {0, 1, 0});

std::optional<Ground> ground_of(const scene::Scene& scene,
                                const scene::Camera& camera = kFromAbove) {
  const auto tracer = trace::RayTracer::build(scene);
  const auto found = ground_under(scene, *tracer, camera, Progress());
  EXPECT_TRUE(found);
  return *found;
}

/// The factor at a place of the ground, seen from above.
Rgb light_at(const Ground& ground, float x, float z) {
  return light_on(ground, {{x, 5, z}, 0, {0, -1, 0}, INFINITY});
}

// The form factor of a rectangle seen from a place of the ground, d before its middle, half as long
// as `a` and `h` high: (atan(a/d) - d/r atan(a/r)) / pi with r^2 = d^2 + h^2.
TEST(GroundUnder, IsDarkerByWhatTheSceneHides) {
  const std::optional<Ground> ground = ground_of(fence(8));
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->height_m, 1, 2e-3);
  for (const float d : {1.0f, 2.0f, 4.0f}) {
    const float r = std::hypot(d, 2.0f);
    const float hidden = (std::atan(4 / d) - d / r * std::atan(4 / r)) / kPi;
    for (const float side : {-1.0f, 1.0f}) {
      const Rgb light = light_at(*ground, 0, side * d);
      EXPECT_NEAR(light.x, 1 - hidden, 0.02) << d;
      EXPECT_NEAR(light.z, 1 - hidden, 0.02) << d;
    }
  }
}

// Shadows end before the ground does; the sky above it is as bright as ever.
TEST(GroundUnder, HasNoBorder) {
  const std::optional<Ground> ground = ground_of(fence(8));
  ASSERT_TRUE(ground);
  EXPECT_EQ(light_at(*ground, 0, ground->half_side_m), (Rgb{1, 1, 1}));
  EXPECT_EQ(light_at(*ground, 1000, 0), (Rgb{1, 1, 1}));
  EXPECT_EQ(light_on(*ground, {{0, 5, 1}, 0, {0, 1, 0}, INFINITY}), (Rgb{1, 1, 1}));
  float before = light_at(*ground, 0, 0.5f * ground->half_side_m).x;
  for (float z = 0.5f; z < 1; z += 0.01f) {
    const float light = light_at(*ground, 0, z * ground->half_side_m).x;
    EXPECT_NEAR(light, before, 0.03) << z;
    before = light;
  }
}

/// The fence, and a square beside it that is level with its lowest place: a foot, or a floor.
scene::Scene fence_and_square(float side_m) {
  scene::Scene scene = fence(8);
  scene::add_rectangle(scene, {-side_m / 2, side_m / 2, -4, side_m - 4}, 1, true, 0);
  return scene;
}

TEST(GroundUnder, IsThereForObjectsSeenFromAbove) {
  EXPECT_TRUE(ground_of(fence_and_square(0.4f)));
  EXPECT_FALSE(ground_of(fence_and_square(4)));
  EXPECT_FALSE(ground_of(fence_and_square(0.4f), camera_at({0, 2, -1}, {0, 1.5f, -4})))
      << "within the box";
  EXPECT_FALSE(ground_of(fence(8), camera_at({0, 0.5f, 9}, {0, -1, 0}))) << "from below";
  EXPECT_FALSE(ground_of(fence(8), camera_at({0, 2, 9}, {0, 2, 0}))) << "an elevation";
  scene::Scene dark = fence(8);
  dark.background = {};
  EXPECT_FALSE(ground_of(dark)) << "nothing is around it";
  scene::Scene framed = fence(8);
  framed.cameras.push_back(kFromAbove);
  EXPECT_FALSE(ground_of(framed)) << "the file has a camera";
}

}  // namespace
}  // namespace luxel::pipeline
