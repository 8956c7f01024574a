#include "luxel/transport/own_side.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "luxel/base/random.h"
#include "luxel/transport/floor_test_support.h"

namespace luxel::transport {
namespace {

/// Light on the floor, per texel: 1 beyond the wall, else 0.
std::vector<Rgb> light_beyond(const Floor& floor, float wall_x) {
  std::vector<Rgb> out;
  for (const atlas::Texel& t : floor.map.texels) {
    const float x = scene::world_position(floor.scene, t.sample).x;
    out.push_back(x > wall_x ? Rgb{1, 1, 1} : Rgb{});
  }
  return out;
}

/// Points all over the floor, and where they lie.
template <class Visit>
void for_points(const Floor& floor, const Visit& visit) {
  for (uint32_t triangle = 0; triangle < 2; ++triangle)
    for (uint32_t k = 0; k < 4000; ++k) {
      Vec2 u = sobol_owen_2d(k, triangle);
      if (u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
      const scene::SurfacePoint p{0, triangle, {u.x, u.y}};
      visit(p, scene::world_position(floor.scene, p));
    }
}

/// A wall of 1 cm through a column of texels: some of each lies on either side, and its sample on
/// one. Light on each side is its own.
TEST(OwnSides, LightStaysBeyondAThinWall) {
  for (const float x : {0.99f, 1.001f, 1.02f, 1.05f}) {
    Floor floor;
    floor.add_box({x, -0.1f, -1}, {x + 0.01f, 1, 3});
    const trace::RayTracer rays = floor.tracer();
    const OwnSides sides = find_own_sides(floor.scene, floor.atlas, floor.map, rays);
    const std::vector<Rgb> light = light_beyond(floor, x + 0.005f);
    for_points(floor, [&](const scene::SurfacePoint& p, Vec3 at) {
      if (at.x > x && at.x < x + 0.01f) return;
      EXPECT_TRUE(has_own_texel(sides, p));
      // Weights are rounded; darkness is not.
      const float e = own_irradiance_at(sides, light, p).x;
      if (at.x > x)
        EXPECT_NEAR(e, 1, 1e-6) << at.x;
      else
        EXPECT_EQ(e, 0) << at.x;
    });
  }
}

/// Between two walls that stand a third of a texel apart, and beside all samples, nothing is read.
TEST(OwnSides, ASlitWithoutSamplesHasNoTexel) {
  Floor floor;
  floor.add_box({0.98f, -0.1f, -1}, {0.99f, 1, 3});  // samples lie at 0.96875 and 1.03125
  floor.add_box({1.01f, -0.1f, -1}, {1.02f, 1, 3});
  const trace::RayTracer rays = floor.tracer();
  const OwnSides sides = find_own_sides(floor.scene, floor.atlas, floor.map, rays);
  for_points(floor, [&](const scene::SurfacePoint& p, Vec3 at) {
    if (at.x > 0.98f && at.x < 0.99f) return;  // in a wall
    if (at.x > 1.01f && at.x < 1.02f) return;
    EXPECT_EQ(has_own_texel(sides, p), at.x < 0.98f || at.x > 1.02f) << at.x << " " << at.z;
  });
}

/// Under a box samples are hidden, and nobody reads them: no look-up is asked for its side.
TEST(OwnSides, AreNotAskedBesideThickThings) {
  Floor floor;
  floor.add_box({0.7f, 0, 0.7f}, {1.3f, 1, 1.3f});
  const trace::RayTracer rays = floor.tracer();
  const OwnSides sides = find_own_sides(floor.scene, floor.atlas, floor.map, rays);
  const auto count = [](const std::vector<uint64_t>& bits) {
    size_t sum = 0;
    for (const uint64_t word : bits) sum += size_t(std::popcount(word));
    return sum;
  };
  EXPECT_EQ(count(sides.mixed), 0u);
  EXPECT_GT(count(sides.beside_solids), 30u);  // its outline is 40 texels long
}

/// A wall hangs above a texel, whose sample lies beside it, in the open. Where the gap is a
/// hundredth of a texel, points under the wall see both sides, and those beyond are not the
/// sample's own. Where it is a fifth of a texel, light passes, and all are.
TEST(OwnSides, FootprintsEndAtWallsThatHangJustAboveTheFloor) {
  constexpr float kTexel = 1 / 16.0f;
  for (const float gap : {0.01f * kTexel, 0.2f * kTexel}) {
    Floor floor;
    floor.add_box({1.01f, gap, -1}, {1.025f, 1, 3});
    const trace::RayTracer rays = floor.tracer();
    const uint32_t texel = floor.map.texel_at[4 * Floor::kSide + 16];  // its sample at x = 1.03125
    const scene::SurfacePoint sample = floor.map.texels[texel].sample;
    const auto& corners = floor.atlas.corners[sample.triangle];
    std::vector<scene::SurfacePoint> points;
    for (uint32_t k = 0; k < 64; ++k)
      points.push_back(
          {0, sample.triangle, atlas::barycentric_in(corners, Vec2{16, 4} + sobol_owen_2d(k, 1))});
    std::vector<uint8_t> on_side(points.size());
    find_on_side(floor.scene, floor.atlas, rays, sample, points, on_side);
    int beyond = 0, under = 0;
    for (size_t k = 0; k < points.size(); ++k) {
      const float x = scene::world_position(floor.scene, points[k]).x;
      if (x > 1.01f && x < 1.025f) {
        ++under;
        continue;
      }
      beyond += x < 1.01f;
      EXPECT_EQ(on_side[k] != 0, x > 1.02f || gap > 0.1f * kTexel) << x << " " << gap;
    }
    EXPECT_GT(beyond, 5);
    EXPECT_GT(under, 5);
  }
}

/// Points of a texel's footprint beyond a wall are not its own; those around a corner are.
TEST(OwnSides, FootprintsEndAtWalls) {
  Floor floor;
  floor.add_box({1.04f, -0.1f, -1}, {1.05f, 1, 3});
  floor.add_box({1.01f, 0, 0.26f}, {1.02f, 1, 0.27f});  // a pole
  const trace::RayTracer rays = floor.tracer();
  const uint32_t texel = floor.map.texel_at[4 * Floor::kSide + 16];  // x from 1 to 1.0625
  const scene::SurfacePoint sample = floor.map.texels[texel].sample;
  const auto& corners = floor.atlas.corners[sample.triangle];
  std::vector<scene::SurfacePoint> points;
  std::vector<bool> is_own;
  for (uint32_t k = 0; k < 256; ++k) {
    const Vec2 at = Vec2{16, 4} + sobol_owen_2d(k, 1);
    points.push_back({0, sample.triangle, atlas::barycentric_in(corners, at)});
    is_own.push_back(at.x / 16 < 1.04f);
  }
  std::vector<uint8_t> on_side(points.size());
  find_on_side(floor.scene, floor.atlas, rays, sample, points, on_side);
  for (size_t k = 0; k < points.size(); ++k) {
    const Vec3 at = scene::world_position(floor.scene, points[k]);
    const bool in_solid = (at.x > 1.04f && at.x < 1.05f) ||
                          (at.x > 1.01f && at.x < 1.02f && at.z > 0.26f && at.z < 0.27f);
    if (in_solid) continue;
    EXPECT_EQ(on_side[k] != 0, is_own[k]) << at.x << " " << at.z;
  }
}

}  // namespace
}  // namespace luxel::transport
