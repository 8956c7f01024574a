#include "luxel/scene/environment.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/base/vec_double.h"
#include "luxel/base/warp.h"

namespace luxel::scene {
namespace {

Environment map_of(int width, int height, float rotation_rad = 0) {
  Environment map{width, height, {}, rotation_rad};
  for (int i = 0; i < width * height; ++i) map.radiance.push_back(Rgb{1, 2, 3} * float(i));
  return map;
}

TEST(Environment, LooksWhereThreeJsAndBlenderLook) {
  const Environment map = map_of(8, 4);
  const auto expect_at = [&](Vec3 d, float u, float v) {
    const Vec2 uv = uv_of(map, d);
    EXPECT_NEAR(uv.x, u, 1e-6f);
    EXPECT_NEAR(uv.y, v, 1e-6f);
  };
  expect_at({0, 0, -1}, 0.25f, 0.5f);
  expect_at({1, 0, 0}, 0.5f, 0.5f);
  expect_at({0, 0, 1}, 0.75f, 0.5f);
  EXPECT_NEAR(uv_of(map, {0, 1, 0}).y, 0, 1e-6f);
  EXPECT_NEAR(uv_of(map, {0, -1, 0}).y, 1, 1e-6f);
}

// A quarter turn of the compass: what stood in the north (-Z) stands in the east (+X).
TEST(Environment, TurnsAsACompassDoes) {
  const Vec2 east = uv_of(map_of(8, 4, kPi / 2), {1, 0, 0});
  EXPECT_NEAR(east.x, 0.25f, 1e-6f);
}

TEST(Environment, PlacesAndDirectionsAreInverse) {
  for (const float turned : {0.0f, 0.7f, -4.0f}) {
    const Environment map = map_of(16, 8, turned);
    for (uint32_t i = 0; i < 1000; ++i) {
      const Vec3 d = uniform_sphere_sample(sobol_owen_2d(i, 1));
      // Two float angles of up to 2 pi, each rounded to 2^-22.
      EXPECT_LE(length(direction_of(map, uv_of(map, d)) - d), 3e-6f);
    }
  }
}

TEST(Environment, PixelsShareTheSphereOut) {
  const Environment map = map_of(12, 6);
  double sum = 0;
  for (int y = 0; y < map.height; ++y) sum += pixel_solid_angle(map, y) * map.width;
  EXPECT_NEAR(sum, 4 * kPiDouble, 1e-12);
  // The cap of a row: 2 pi (1 - cos(pi / 6)).
  EXPECT_NEAR(pixel_solid_angle(map, 0) * 12, 2 * kPiDouble * (1 - std::sqrt(0.75)), 1e-12);
}

TEST(Environment, IsConstantOverAPixelAndSmoothInPictures) {
  const Environment map = map_of(8, 4);
  for (const float inside : {0.05f, 0.5f, 0.95f}) {
    const Vec3 d = direction_of(map, {(3 + inside) / 8, (2 - inside) / 4});
    EXPECT_EQ(radiance_towards(map, d), map.radiance[8 + 3]);
  }
  // Half way between the centres of pixels 11 and 12, and across the border of the map: 15 and 8.
  EXPECT_NEAR(smooth_radiance_towards(map, direction_of(map, {0.5f, 1.5f / 4})).x, 11.5f, 1e-4f);
  EXPECT_NEAR(smooth_radiance_towards(map, direction_of(map, {0, 1.5f / 4})).x, 11.5f, 1e-4f);
  EXPECT_NEAR(smooth_radiance_towards(map, direction_of(map, {0.5f / 8, 2.0f / 4})).x, 12, 1e-4f);
  // Beyond the centres of the first row there is nothing more.
  EXPECT_NEAR(smooth_radiance_towards(map, direction_of(map, {2.5f / 8, 0.01f})).x, 2, 1e-4f);
}

// L pi of a sky of one radiance, half of it where only one half of the azimuths shines.
TEST(Environment, BringsAHorizontalSurfaceItsCosine) {
  Environment map{16, 8, std::vector<Rgb>(128, {1, 2, 3}), 0};
  EXPECT_NEAR(horizontal_irradiance(map).y, 2 * kPi, 1e-5f);
  for (size_t i = 0; i < 128; ++i)
    if (i % 16 < 8) map.radiance[i] = {};
  EXPECT_NEAR(horizontal_irradiance(map).z, 1.5f * kPi, 1e-5f);
}

}  // namespace
}  // namespace luxel::scene
