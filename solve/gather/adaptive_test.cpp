// Rounds of samples, and how sure their light is.
#include "solve/gather/adaptive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/procedural.h"
#include "solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

// 64 samples and 192 more are the 256 that one round traces: the light differs by the order of the
// sums, 256 roundings of 6e-8 at most, five times that after all bounces.
TEST(Rounds, AreTheSamplesOfOneRound) {
  const auto laid_out = lay_out(scene::cornell_box(), 32);
  const Room& room = *laid_out;
  Progress progress;
  const size_t n = room.elements.size();
  const std::vector<uint16_t> all(n, 256);
  std::vector<uint16_t> first(n, 64);
  for (size_t i = 0; i < n; i += 3) first[i] = 128;
  for (size_t i = 1; i < n; i += 3) first[i] = 0;
  TracedHits rounds = no_hits(n);
  for (const auto& target : {first, all})
    ASSERT_TRUE(trace_more(room.scene, room.atlas, room.elements, room.lights.around, *room.tracer,
                           target, {}, rounds, progress));
  const auto once = trace_hits(room.scene, room.atlas, room.elements, room.lights.around,
                               *room.tracer, 256, {}, progress);
  ASSERT_TRUE(once);
  EXPECT_EQ(rounds.samples, once->samples);
  EXPECT_EQ(rounds.escaped, once->escaped);
  EXPECT_EQ(rounds.rays, once->rays);
  const std::vector<Rgb> direct(n, {1, 1, 1});
  const auto a = bounce(room.map, room.elements, rounds, direct, {}, {-1, 1e-6f}, progress);
  const auto b = bounce(room.map, room.elements, *once, direct, {}, {-1, 1e-6f}, progress);
  ASSERT_TRUE(a && b);
  for (size_t i = 0; i < n; ++i) {
    ASSERT_NEAR(a->irradiance[i].x, b->irradiance[i].x, 8e-5f * b->irradiance[i].x);
    // A difference of two halves: what is left of the rounding of each, squared.
    ASSERT_NEAR(std::sqrt(a->split_variance[i]), std::sqrt(b->split_variance[i]),
                8e-5f * b->irradiance[i].x);
  }
}

// Half as many tiles fit into memory as the round needs: the rest is read from files.
TEST(Rounds, GoToFilesWhenMemoryIsShort) {
  const auto room = lay_out(scene::cornell_box(), 32);
  GatherParams params;
  params.samples = 32, params.max_error = 0.1f;
  const Gather in_memory = solve(*room, params);
  params.hit_memory_bytes = 100'000;
  const Gather in_files = solve(*room, params);
  EXPECT_GT(in_files.hit_bytes_in_file, 0u);
  EXPECT_EQ(in_files.irradiance, in_memory.irradiance);
}

// The judge: 64 times the rays of what is judged, with noise of its own about a tenth as large.
class SlowAdaptive : public testing::Test {
 protected:
  static const Room& room() {
    static const auto instance = lay_out(scene::cornell_box(), 64);
    return *instance;
  }
  static const Gather& judge() {
    static const Gather instance =
        solve(room(), {.samples = 16384, .direct_samples = 4096, .supersample = 256, .seed = 7});
    return instance;
  }
};

// What is claimed: 95 of 100 texels are sure to `max_error` of their light. Their true errors stay
// below that in the mean over texels, and within twice the estimate at 9 texels of 10 and more (19
// of 20 for a normal error that is known exactly; the estimate is one from few squares, but rather
// too large than too small, because halves are less well spread than the whole).
TEST_F(SlowAdaptive, TheErrorIsWhatWasAskedFor) {
  for (const float max_error : {0.05f, 0.02f}) {
    const Gather light = solve(
        room(), {.samples = 32, .max_error = max_error, .direct_samples = 16, .supersample = 16});
    EXPECT_LE(light.relative_error_p95, max_error);
    double mean = 0;
    for (const Rgb& e : judge().irradiance)
      mean += double(luminance(e)) / double(judge().irradiance.size());
    size_t judged = 0, within = 0;
    double sum2 = 0;
    for (size_t i = 0; i < light.irradiance.size(); ++i) {
      if (light.enclosed[i]) continue;
      const double e = luminance(judge().irradiance[i]);
      const double error = std::abs(double(luminance(light.irradiance[i])) - e);
      ++judged;
      within += error <= 2 * std::sqrt(double(light.pooled_variance[i]));
      const double relative = error / std::max(e, 0.1 * mean);
      sum2 += relative * relative;
    }
    EXPECT_GT(double(within), 0.9 * double(judged)) << max_error;
    EXPECT_LT(std::sqrt(sum2 / double(judged)), max_error);
    // Nor is it much better than asked for: rays are dear.
    EXPECT_GT(std::sqrt(sum2 / double(judged)), max_error / 5);
  }
}

}  // namespace
}  // namespace luxel::gather
