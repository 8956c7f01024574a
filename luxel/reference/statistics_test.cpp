// The path tracer's statements about itself: the rate, the standard error, the same bits; and the
// agreement of its two ways to find emitters.
#include <gtest/gtest.h>

#include <bit>

#include "luxel/base/parallel.h"
#include "luxel/reference/paths.h"
#include "luxel/reference/reference_test_support.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/procedural.h"

namespace luxel::reference {
namespace {

using namespace testing;

double rms_error(const TexelPaths& result, double exact) {
  double sum2 = 0;
  for (const Rgb& e : result.irradiance) sum2 += (double(e.x) - exact) * (double(e.x) - exact);
  return std::sqrt(sum2 / double(result.irradiance.size()));
}

// Twice the samples, 0.71 times the error: the true error, in a furnace, over 4000 points. Each
// ratio is known to 1 / sqrt(4000) or 1.6 %.
TEST(SlowStatistics, TwiceTheSamplesGive071TimesTheError) {
  const scene::Scene scene = scene::furnace_box(gray(0.5f), gray(1));
  const Points points = random_points(scene, 4000, 1);
  const double exact = 2 * double(kPi);
  double before = 0;
  for (uint64_t k = 0; k < 6; ++k) {
    const int samples = 16 << k;
    const double error = rms_error(solve(scene, points, {.samples = samples, .seed = k}), exact);
    if (before > 0) {
      EXPECT_NEAR(error / before, std::sqrt(0.5), 3 * 0.016 * std::sqrt(0.5)) << samples;
    }
    before = error;
  }
}

// z = (value - exact) / standard error has mean 0 and variance 1: over 4000 points the mean of z is
// known to 0.016 and the mean of its square to sqrt(2 / 4000) = 0.022.
TEST(SlowStatistics, TheStandardErrorIsHonest) {
  const scene::Scene scene = scene::furnace_box(gray(0.5f), gray(1));
  const Points points = random_points(scene, 4000, 2);
  const TexelPaths result = solve(scene, points, {.samples = 300, .seed = 5});
  const double exact = 2 * double(kPi);
  double sum = 0, sum2 = 0, sum2_luminance = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double z = (double(result.irradiance[i].y) - exact) / double(result.standard_error[i].y);
    const double zl =
        (double(luminance(result.irradiance[i])) - exact) / double(result.luminance_error[i]);
    sum += z, sum2 += z * z, sum2_luminance += zl * zl;
  }
  const double n = double(points.size());
  EXPECT_NEAR(sum / n, 0, 3 * 0.016);
  EXPECT_NEAR(sum2 / n, 1, 4 * 0.022);
  EXPECT_NEAR(sum2_luminance / n, 1, 4 * 0.022);
  // relative_error is the root mean square of the same errors over the mean.
  EXPECT_NEAR(result.relative_error, rms_error(result, exact) / exact,
              0.05 * result.relative_error);
}

// Cells have the area that they stand for, and a place in the middle of one lies in no other.
TEST(Statistics, CellsFillTheSquare) {
  for (const uint32_t count : {1u, 2u, 7u, 64u, 100u, 4096u}) {
    std::vector<DVec2> lower, upper;
    for (uint32_t k = 0; k < count; ++k) {
      lower.push_back(point_in({k, count}, {0, 0})), upper.push_back(point_in({k, count}, {1, 1}));
      const DVec2 size = upper[k] - lower[k];
      EXPECT_NEAR(size.x * size.y * count, 1, 1e-9) << k << " of " << count;
    }
    const DVec2 middle = point_in({count / 2, count}, {0.5f, 0.5f});
    for (uint32_t k = 0; k < count; ++k) {
      const bool inside = middle.x > lower[k].x && middle.x < upper[k].x && middle.y > lower[k].y &&
                          middle.y < upper[k].y;
      EXPECT_EQ(inside, k == count / 2) << k << " of " << count;
    }
  }
}

// An order has every place once, and orders differ.
TEST(Statistics, EachPairOfNumbersHasEveryCellOnce) {
  for (const uint32_t count : {1u, 2u, 7u, 100u, 4096u}) {
    std::vector<std::array<uint32_t, 3>> times(count);
    uint32_t alike = 0;
    for (uint32_t k = 0; k < count; ++k) {
      Cells cells{{k, count}, 5};
      std::array<uint32_t, 3> number{};
      for (size_t pair = 0; pair < 3; ++pair) {
        number[pair] = next_cell(cells).number;
        ++times[number[pair]][pair];
      }
      alike += number[0] == number[1];
    }
    for (const auto& t : times) EXPECT_EQ(t, (std::array<uint32_t, 3>{1, 1, 1})) << count;
    // By chance about one is.
    if (count >= 100) {
      EXPECT_LE(alike, 8u);
    }
  }
}

// Paths of one place are spread over a lamp's square and over what the place sees: 500 answers of
// 1,024 paths agree in the mean with Howell's factor, and scatter by less than half of what
// independent paths would, and they state. z^2 of 500 answers is known to 6 %.
TEST(Statistics, PathsOfOnePlaceErrByLessThanTheyState) {
  scene::Scene scene;
  const uint32_t glow = scene::add_material(scene, "lamp", {}, gray(1));
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, false, glow);
  Points place;
  for (int k = 0; k < 16; ++k) place.add({0.3f, 0, 0.2f}, {0, 1, 0});
  const double exact = kPiDouble * viewfactor::rectangle_factor(-0.8, 0.2, -0.7, 0.3, 1);
  double sum = 0, sum2 = 0;
  for (uint64_t seed = 0; seed < 500; ++seed) {
    const TexelPaths light =
        solve(scene, place, {.samples = 64, .bounces = 0, .seed = seed, .is_one_place = true});
    double mean = 0, variance = 0;
    for (size_t i = 0; i < place.size(); ++i) {
      mean += double(light.irradiance[i].x) / 16;
      variance += std::pow(double(light.standard_error[i].x) / 16, 2);
    }
    const double z = (mean - exact) / std::sqrt(variance);
    sum += z, sum2 += z * z;
  }
  EXPECT_NEAR(sum / 500, 0, 3 * std::sqrt(sum2) / 500);
  EXPECT_LT(sum2 / 500, 0.25);
}

TEST(Statistics, NoLightHasNoErrorAndOnePathSaysNothing) {
  const Points points = random_points(scene::furnace_box(gray(0.5f), gray(1)), 10, 3);
  const TexelPaths dark = solve(scene::furnace_box(gray(0.5f), {}), points, {.samples = 10});
  const TexelPaths one = solve(scene::furnace_box(gray(0.5f), gray(1)), points, {.samples = 1});
  EXPECT_EQ(dark.relative_error, 0);
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(dark.irradiance[i], (Rgb{}));
    EXPECT_EQ(one.standard_error[i], one.irradiance[i]);
  }
}

uint64_t hash_of(const TexelPaths& result) {
  uint64_t h = 0;
  for (const std::vector<Rgb>* values : {&result.irradiance, &result.standard_error})
    for (const Rgb& v : *values)
      for (const float c : {v.x, v.y, v.z}) h = h * 0x100000001b3ull ^ std::bit_cast<uint32_t>(c);
  return h;
}

TEST(Statistics, TheSameSeedGivesTheSameBitsForAnyNumberOfThreads) {
  const scene::Scene scene = scene::spheres_and_cube();
  const Points points = random_points(scene, 3000, 4);
  std::vector<uint64_t> hashes, rays;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    const TexelPaths result = solve(scene, points, {.samples = 20});
    hashes.push_back(hash_of(result)), rays.push_back(result.rays);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
  EXPECT_EQ(rays[0], rays[2]);
  EXPECT_NE(hashes[0], hash_of(solve(scene, points, {.samples = 20, .seed = 2})));
}

TEST(Statistics, CancellingStopsIt) {
  const scene::Scene scene = scene::cornell_box();
  const auto tracer = trace::RayTracer::build(scene);
  const Points points = random_points(scene, 1000, 4);
  Progress progress;
  progress.request_cancel();
  const auto result = irradiance_by_paths(scene, {points.position, points.normal, points.normal},
                                          *tracer, {.samples = 100}, progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
}

struct Estimate {
  double mean = 0, error = 0;
};
Estimate estimate(const TracedScene& world, const Receiver& at, int count) {
  std::vector<Path> paths;
  for (int k = 0; k < count; ++k) paths.push_back(path_from(at, {hash64(7, uint64_t(k))}));
  PathBuffers work;
  follow(world, -1, paths, work);
  double sum = 0, sum2 = 0;
  for (const Path& path : paths)
    sum += double(path.value.x), sum2 += double(path.value.x) * double(path.value.x);
  const double n = double(count);
  return {sum / n, std::sqrt((sum2 / n - sum / n * sum / n) / n)};
}

// An emitter that is never picked counts in full where a ray finds it: picking some, all or none of
// them must not change the mean, only the noise.
TEST(Statistics, PickingEmittersOrMeetingThemByChanceGivesTheSame) {
  scene::Scene scene = scene::furnace_box(gray(0.6f), {});
  scene::add_material(scene, "lamp", gray(0.3f), {3, 2, 1});
  const Box3 room = scene::world_bounds(scene);
  scene::add_rectangle(
      scene, {room.lower.x + 0.2f, room.lower.x + 0.6f, room.lower.z + 0.3f, room.lower.z + 0.6f},
      room.upper.y - 0.1f, false, 1);
  const auto tracer = trace::RayTracer::build(scene);
  const Vec3 n{0, 1, 0};
  const Vec3 middle{room.centre().x, room.lower.y, room.centre().z};
  const Receiver at{scene::off_surface(middle, n, 1), n, n};
  TracedScene world = traced_scene(scene, *tracer);
  ASSERT_EQ(world.emitters.triangles.size(), 2u);
  const Estimate both = estimate(world, at, 100000);
  // Only the first of two triangles is picked, with certainty.
  world.emitters.triangles[0].pdf_area *= 2;
  const uint32_t first = world.surfaces.number(1, 0);
  world.emitters.pdf_area[first] *= 2, world.emitters.pdf_area[first + 1] = 0;
  world.emitters.triangles.resize(1);
  world.emitters.chance_below = {0, 1};
  const Estimate some = estimate(world, at, 100000);
  world.emitters = {};
  world.emitters.pdf_area.assign(world.surfaces.front.size(), 0.0f);
  const Estimate none = estimate(world, at, 200000);
  EXPECT_NEAR(both.mean, some.mean, 3 * std::hypot(both.error, some.error));
  EXPECT_NEAR(both.mean, none.mean, 3 * std::hypot(both.error, none.error));
  EXPECT_LT(none.error, 0.01 * none.mean);
  EXPECT_LT(both.error, none.error);
}

}  // namespace
}  // namespace luxel::reference
