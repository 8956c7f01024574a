// Where places lie in the picture before and after a move, asked of the rays that draw it.
#include "luxel/view/model/camera_moves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/trace/camera_rays.h"

namespace luxel::view {
namespace {

/// The picture is 3 : 2; parts of its height are pixels over 200.
constexpr int kWidth = 300, kHeight = 200;
constexpr float kAspect = 1.5f;

/// Where a place lies in the picture, in pixels; z is how far ahead it is [m].
Vec3 pixel_of(const scene::Camera& camera, Vec3 place) {
  const trace::CameraRays rays(camera, kWidth, kHeight);
  const Vec3 to = place - rays.eye;
  const float ahead = dot(to, rays.forward), scale = rays.orthographic ? 1 : ahead;
  const float x = dot(to, rays.right) / (dot(rays.right, rays.right) * scale);
  const float y = dot(to, rays.up) / (dot(rays.up, rays.up) * scale);
  return {0.5f * kWidth * (1 + x), 0.5f * kHeight * (1 - y), ahead};
}

void expect_near(Vec3 a, Vec3 b, float tolerance, const char* what) {
  EXPECT_LE(length(a - b), tolerance) << what << ": (" << a.x << ", " << a.y << ", " << a.z
                                      << ") for (" << b.x << ", " << b.y << ", " << b.z << ")";
}

/// Looks from (3, 4, 12) towards (0, 1, 0), at its feet the horizon a little aslant.
std::vector<scene::Camera> cameras() {
  scene::Camera camera;
  const Vec3 back = normalize(Vec3{3, 3, 12});
  const Vec3 right = normalize(cross(Vec3{0.1f, 1, 0}, back));
  camera.world_from_camera = from_columns(right, cross(back, right), back, {3, 4, 12});
  scene::Camera parallel = camera, wide = camera;
  parallel.orthographic_height_m = 5;
  wide.aspect = 2;  // wider than the picture, which then shows more above and below
  return {camera, parallel, wide};
}

constexpr Vec3 kTarget{0.5f, 1, -1};

TEST(CameraMoves, OrbitKeepsTheTargetInItsPlace) {
  for (const scene::Camera& camera : cameras()) {
    const scene::Camera moved = orbited(camera, kTarget, 0.7f, 0.3f);
    expect_near(pixel_of(moved, kTarget), pixel_of(camera, kTarget), 2e-3f, "the target");
    // Seen from above the eye has turned counter-clockwise, from +z towards +x, and it has risen.
    const Vec3 before = column(camera.world_from_camera, 2),
               after = column(moved.world_from_camera, 2);
    const float turned_by = std::atan2(after.x, after.z) - std::atan2(before.x, before.z);
    EXPECT_NEAR(turned_by, 0.7f, 1e-5f);
    EXPECT_NEAR(std::asin(after.y) - std::asin(before.y), 0.3f, 1e-5f);
    const scene::Camera back = orbited(moved, kTarget, -0.7f, -0.3f);
    expect_near(column(back.world_from_camera, 3), {3, 4, 12}, 1e-5f, "there and back");
  }
}

TEST(CameraMoves, OrbitNeverTurnsOver) {
  for (const float up : {3.0f, -3.0f}) {
    scene::Camera camera = cameras()[0];
    for (int i = 0; i < 10; ++i) camera = orbited(camera, kTarget, 0.1f, up);
    const float elevation = std::asin(column(camera.world_from_camera, 2).y) * 180 / kPi;
    EXPECT_NEAR(elevation, up > 0 ? 89 : -89, 0.05f);
    EXPECT_GT(column(camera.world_from_camera, 1).y, 0) << "up stays up";
  }
  // One that looks straight down turns about the vertical, and can be raised from there.
  scene::Camera down;
  down.world_from_camera = from_columns({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 5, 0});
  const scene::Camera aside = orbited(down, {}, kPi / 2, 0);
  expect_near(column(aside.world_from_camera, 2), {0, 1, 0}, 1e-6f, "still down");
  expect_near(column(aside.world_from_camera, 0), {0, 0, -1}, 1e-6f, "turned");
  EXPECT_NEAR(std::asin(column(orbited(down, {}, 0, -0.5f).world_from_camera, 2).y), kPi / 2 - 0.5f,
              1e-3f);
}

TEST(CameraMoves, TurningStaysInItsPlace) {
  const scene::Camera camera = cameras()[0], moved = turned(camera, 0.2f, 0.1f);
  expect_near(column(moved.world_from_camera, 3), {3, 4, 12}, 1e-6f, "the eye");
  const Vec3 before = -column(camera.world_from_camera, 2),
             after = -column(moved.world_from_camera, 2);
  EXPECT_NEAR(std::asin(after.y) - std::asin(before.y), 0.1f, 1e-5f) << "looks up";
  // To the left: what stood in the middle is further right now.
  EXPECT_GT(pixel_of(moved, {0, 1, 0}).x, pixel_of(camera, {0, 1, 0}).x);
}

TEST(CameraMoves, PanMovesTheTargetAsFarAsThePointer) {
  for (const scene::Camera& camera : cameras()) {
    const Vec3 before = pixel_of(camera, kTarget);
    const Vec3 after = pixel_of(panned(camera, kTarget, {0.1f, -0.25f}, kAspect), kTarget);
    expect_near(after, before + Vec3{20, -50, 0}, 2e-3f, "20 pixels to the right, 50 up");
  }
}

TEST(CameraMoves, ApproachKeepsThePlaceUnderThePointer) {
  for (const scene::Camera& camera : cameras())
    for (const float factor : {0.5f, 2.0f}) {
      const scene::Camera moved = approached(camera, kTarget, factor);
      const Vec3 before = pixel_of(camera, kTarget), after = pixel_of(moved, kTarget);
      EXPECT_NEAR(after.x, before.x, 2e-3f);
      EXPECT_NEAR(after.y, before.y, 2e-3f);
      const bool is_parallel = camera.orthographic_height_m > 0;
      EXPECT_NEAR(after.z, is_parallel ? before.z : before.z * factor, 1e-4f);
      // A point beside the place, at its depth, is 1 / factor as far from it in the picture.
      const Vec3 beside = kTarget + normalize(column(camera.world_from_camera, 1));
      EXPECT_NEAR(after.y - pixel_of(moved, beside).y,
                  (before.y - pixel_of(camera, beside).y) / factor, 5e-3f);
    }
}

TEST(CameraMoves, FlyingGoesAlongTheAxes) {
  scene::Camera camera;  // looks along -z from the origin
  camera.world_from_camera = scaling({3, 3, 3});
  const scene::Camera moved = flown(camera, {1, 2, 4});
  expect_near(column(moved.world_from_camera, 3), {1, 2, -4}, 1e-6f, "the eye");
  expect_near(column(moved.world_from_camera, 0), {1, 0, 0}, 1e-6f, "of unit length");
}

TEST(CameraMoves, FrameShowsTheWholeBox) {
  Box3 box;
  box.extend({-1, 2, 5}), box.extend({4, 3, 9});
  for (const scene::Camera& camera : cameras()) {
    const scene::Camera moved = framed(camera, box, kAspect);
    EXPECT_EQ(
        length(column(moved.world_from_camera, 2) - normalize(column(camera.world_from_camera, 2))),
        0);
    const Vec3 middle = pixel_of(moved, box.centre());
    expect_near({middle.x, middle.y, 0}, {150, 100, 0}, 2e-3f, "the middle");
    float farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at{corner & 1 ? 4.0f : -1.0f, corner & 2 ? 3.0f : 2.0f, corner & 4 ? 9.0f : 5.0f};
      const Vec3 pixel = pixel_of(moved, at);
      EXPECT_GT(pixel.z, 0) << "before the eye";
      EXPECT_TRUE(pixel.x >= 0 && pixel.x <= kWidth && pixel.y >= 0 && pixel.y <= kHeight);
      farthest = std::max(farthest, std::hypot(pixel.x - 150, pixel.y - 100));
    }
    EXPECT_GT(farthest, 60) << "and it is large in it";
  }
}

}  // namespace
}  // namespace luxel::view
