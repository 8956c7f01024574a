#include "luxel/trace/camera_rays.h"

#include <gtest/gtest.h>

namespace luxel::trace {
namespace {

// A place faces a camera where a ray through the picture meets it from the front: rays know.
TEST(CameraRays, PlacesOfThePictureFaceTheCamera) {
  scene::Camera camera;
  camera.world_from_camera.row = {{{0, 0, 1, 5}, {0, 1, 0, 2}, {-1, 0, 0, 1}}};  // looks along -x
  for (const float height_m : {0.0f, 3.0f}) {
    camera.orthographic_height_m = height_m;
    const CameraRays rays(camera, 200, 100);
    for (const float x : {-0.1f, 0.01f, 0.5f, 0.99f, 1.1f})
      for (const float y : {-0.1f, 0.01f, 0.5f, 0.99f, 1.1f}) {
        const Ray ray = rays.through(200 * x, 100 * y);
        const Vec3 place = ray.origin + ray.direction * 7.0f;
        const bool is_in = x > 0 && x < 1 && y > 0 && y < 1;
        EXPECT_EQ(faces(rays, place, ray.direction * -1.0f), is_in) << x << " " << y;
        EXPECT_FALSE(faces(rays, place, ray.direction)) << "its back";
        EXPECT_NEAR(rays.pixel_of(place).x, 200 * x, 1e-3f);
        EXPECT_NEAR(rays.pixel_of(place).y, 100 * y, 1e-3f);
        const Vec3 behind = ray.origin - ray.direction * 7.0f;
        if (height_m == 0) {
          EXPECT_FALSE(faces(rays, behind, ray.direction));
        }
      }
  }
}

}  // namespace
}  // namespace luxel::trace
