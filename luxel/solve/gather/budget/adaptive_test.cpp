// Rounds of samples, and how sure their light is.
#include "luxel/solve/gather/budget/adaptive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "luxel/atlas/neighbours.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/budget/error_p95.h"
#include "luxel/solve/gather/budget/texel_error.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/trace/trace_hits.h"

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
    ASSERT_TRUE(
        trace_more(trace_scene(scene_of(room)), target, {.follows_near = true}, rounds, progress));
  const auto once = trace_hits(trace_scene(scene_of(room)), 256, {.follows_near = true}, progress);
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
  const Gather in_files = solve(*room, params, {.hit_memory_bytes = 100'000});
  EXPECT_GT(in_files.hit_bytes_in_file, 0u);
  EXPECT_EQ(in_files.irradiance, in_memory.irradiance);
}

// One value everywhere, whose ratio is a quarter: the mean is that of the split estimate, whatever
// all those are who have fewer samples.
TEST(PooledVariances, LeaveOutWhoIsNotAmong) {
  const auto room = lay_out(scene::cornell_box(), 32);
  const size_t n = room->elements.size();
  std::vector<float> independent(n, 4000), split(n, 9000);
  std::vector<uint32_t> among;
  for (uint32_t i = 0; i < n; ++i)
    if (room->map.texels[i].x % 6 < 3) among.push_back(i);
  for (const uint32_t i : among) independent[i] = 4, split[i] = 1;
  const auto pooled = pooled_variances(room->atlas, room->map, {independent, split}, among);
  for (const uint32_t i : among) ASSERT_FLOAT_EQ(pooled[i], 1);
}

// Errors fall by 2^-0.7 = 0.62 when samples double: 0.03 is below 0.02 after one doubling, 0.06 is
// not after two, which are asked for at once; 0.01 is.
TEST(NextSamples, DoubleOrQuadrupleWhereTheErrorIsTooLarge) {
  const std::vector<float> errors{0.01f, 0.03f, 0.06f, 0.06f};
  const std::vector<uint16_t> samples{32, 32, 32, 1024};
  EXPECT_EQ(next_samples(errors, 0.02f, 2048, samples), (std::vector<uint16_t>{32, 64, 128, 2048}));
  EXPECT_EQ(next_samples(errors, 0.02f, 1024, samples), (std::vector<uint16_t>{32, 64, 128, 1024}));
}

// Where all err alike, 95 of 100 err by less than 1.96 standard errors. Where half do not err, a
// tenth of the others may err by more: 1.645 standard errors.
TEST(ErrorP95, IsThatOfNormalErrors) {
  std::vector<float> s(1000, 0.02f);
  EXPECT_NEAR(error_p95(s), 1.95996 * 0.02, 1e-5);
  std::fill_n(s.begin(), 500, 0.0f);
  EXPECT_NEAR(error_p95(s), 1.64485 * 0.02, 1e-5);
  EXPECT_NEAR(error_p95(s, [](size_t i) { return i >= 500; }), 1.95996 * 0.02, 1e-5);
  EXPECT_EQ(error_p95(std::vector<float>(10)), 0);
  // 25 of 1,000 are lost, and half of the 50 that may err by more are left to the others.
  std::fill_n(s.begin(), 1000, 0.02f), std::fill_n(s.begin(), 25, 1e6f);
  EXPECT_NEAR(error_p95(s), 0.02 * 2.23161, 1e-5);
}

// A texel with twice the light of all others. Linear light around it is too bright by (1 + 1 - 4) /
// 12 along both axes there and by (2 + 1 - 2) / 12 in its four neighbours; errors of 6.9 texels
// count as one. A quarter of the light has not been reflected before.
TEST(TexelError, IsThatOfLightBetweenTexels) {
  const auto room = lay_out(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}), 32);
  const size_t n = room->elements.size();
  TracedHits hits = no_hits(n);
  std::fill(hits.samples.begin(), hits.samples.end(), uint16_t(1));
  std::vector<Rgb> light(n, {1, 1, 1});
  const std::vector<Rgb> direct(n, {0.25f, 0.25f, 0.25f});
  const auto found = [&] {
    return error_by_neighbours(room->atlas, room->map, room->elements, hits, direct, light);
  };
  const auto error = [&] { return found().error; };
  EXPECT_NEAR(found().gain, 4, 1e-6);
  EXPECT_EQ(error(), 0);
  const auto chart = [&](size_t i) {
    return room->atlas.chart[room->map.texels[i].triangle_number];
  };
  size_t inner = n;  // one that is two texels and more from the border of its chart
  for (size_t i = 0; i < n && inner == n; ++i) {
    int count = 0;
    for_neighbours(room->map, i, 2, [&](uint32_t j) { count += chart(j) == chart(i); });
    if (count == 25) inner = i;
  }
  ASSERT_LT(inner, n);
  light[inner] = {2, 2, 2};
  EXPECT_NEAR(error(), std::sqrt(6.9 * (1.0 / 9 + 4.0 / 144)) / (0.25 * double(n)), 1e-6);
}

// To 0.0392 = 1.96 x 0.02 with lamps as sure as the rest, each part may have a standard error of
// 0.0141. 100 texels at 0.02 are at 0.0123 after one doubling. 20 of 100 at 0.1 are at 0.038 with
// four times the samples, which is not enough for 15 of them, and at 0.0144 with 16 times.
TEST(RoundsToCome, EndWhenNineteenOfTwentyAreSure) {
  std::vector<float> gathered(100, 0.02f), all(100, 0.03f);
  const std::vector<uint16_t> samples(100, 32);
  const auto rounds = [&](float max_error, int max_samples) {
    return rounds_to_come(all, gathered, max_error, max_samples, samples);
  };
  EXPECT_EQ(rounds(0.0392f, 2048), (std::vector<uint64_t>{3200}));
  std::fill_n(gathered.begin(), 20, 0.1f), std::fill_n(all.begin(), 20, 0.11f);
  EXPECT_EQ(rounds(0.0392f, 2048), (std::vector<uint64_t>{80 * 32 + 20 * 96, 20 * 384}));
  EXPECT_TRUE(rounds(0.13f, 2048).empty());
  EXPECT_TRUE(rounds(0.0392f, 32).empty()) << "nobody may have more";
}

// Gains e^2 / n are 4, 1, 16 and 2 units: of 32 samples each, 70 pay the two largest.
TEST(KeepAffordable, SamplesGoWhereTheyHelpMost) {
  const std::vector<float> errors{0.02f, 0.01f, 0.04f, 0.02f};
  const std::vector<uint16_t> samples{32, 32, 32, 64};
  const std::vector<uint16_t> wanted{64, 64, 64, 128};
  std::vector<uint16_t> target = wanted;
  keep_affordable(errors, 70, samples, target);
  EXPECT_EQ(target, (std::vector<uint16_t>{64, 32, 64, 64}));
  target = wanted;
  keep_affordable(errors, 1000, samples, target);
  EXPECT_EQ(target, wanted);
}

// Four texels with a ray each per sample of 16, the next level takes four times as many: 64 each.
TEST(AffordableError, LetsInAsManyAsThereAreRaysFor) {
  const std::vector<float> errors{0.1f, 0.4f, 0.2f, 0.3f};
  const light::DirectLevels levels{std::vector<uint8_t>(4), std::vector<uint8_t>(4)};
  const light::SupersampleParams params{.points = 16, .direct = {.samples = 16}};
  EXPECT_EQ(affordable_error(errors, 0.05f, 1000, params, levels), 0.05f);
  EXPECT_EQ(affordable_error(errors, 0.05f, 150, params, levels), 0.2f) << "two are above it";
  EXPECT_EQ(affordable_error(errors, 0.25f, 1000, params, levels), 0.25f);
}

// With a budget rounds follow as long as there is time; a tenth of a second is worth more than the
// first 4 samples on any machine, and the hour is not waited for: nobody gets more than 64.
TEST(Seconds, AreUsedAndNotWaitedFor) {
  const auto room = lay_out(scene::cornell_box(), 16);
  GatherParams params;
  params.samples = 4, params.max_samples = 64, params.seconds = 3600;
  const Gather light = solve(*room, params);
  // Texels that see nothing have no error.
  EXPECT_GT(std::ranges::count(light.samples, 64),
            std::ptrdiff_t(0.9 * double(light.samples.size())));
  params.seconds = 1e-9;
  const Gather none = solve(*room, params);
  EXPECT_EQ(none.samples, std::vector<uint16_t>(room->elements.size(), 4));
}

struct Shown {
  std::vector<Rgb> irradiance;
  double samples = 0;
  float error = 0;
};
std::vector<Shown> watched(const Room& room, const GatherParams& params, Gather& result) {
  std::vector<Shown> out;
  const auto on_estimate = [&](const light::LightEstimate& e) {
    out.push_back({{e.irradiance.begin(), e.irradiance.end()}, e.samples, e.error_p95});
  };
  result = solve(room, params, {}, nullptr, {.on_estimate = on_estimate});
  return out;
}

// In a furnace all surfaces get pi e / (1 - rho): direct light and ambient term are the whole of it
// before the first ray. Its walls are all lamps, whose light has no noise where they are seen
// whole.
TEST(Estimates, BeginWithAnAmbientTerm) {
  const float rho = 0.5f;
  const auto room = lay_out(scene::furnace_box({rho, rho, rho}, {1, 1, 1}), 32);
  Gather result;
  const std::vector<Shown> shown = watched(*room, with_samples(16), result);
  EXPECT_EQ(shown.front().samples, 0);
  double mean = 0;
  for (const Rgb& e : shown.front().irradiance)
    mean += double(e.x) / double(shown.front().irradiance.size());
  // Texels in edges have lamps at grazing angles, whose visible share is drawn: 0.1 % in the mean.
  EXPECT_NEAR(mean, double(kPi) / 0.5, 0.002 * double(kPi) / 0.5);
}

// Whatever comes first, and whoever asks for it: the last estimate is the result, which is that of
// one who is not watched, bit by bit.
TEST(Estimates, GrowIntoTheResult) {
  const auto room = lay_out(scene::cornell_box(), 32);
  const Gather unwatched = solve(*room, with_samples(64));
  GatherObserver observer;
  const size_t half = room->elements.size() / 2;
  observer.is_watched = [&](size_t element) { return element > half; };
  std::vector<Rgb> last;
  observer.on_estimate = [&](const light::LightEstimate& e) {
    last.assign(e.irradiance.begin(), e.irradiance.end());
  };
  const Gather result = solve(*room, with_samples(64), {}, nullptr, observer);
  EXPECT_EQ(last, result.irradiance);
  EXPECT_EQ(result.irradiance, unwatched.irradiance);
  EXPECT_EQ(result.errors, unwatched.errors);
}

// Rounds to an error are shown one by one.
TEST(Estimates, GoOnWithRounds) {
  const auto room = lay_out(scene::cornell_box(), 32);
  GatherParams params = with_samples(16);
  params.max_error = 0.1f;
  Gather result;
  const std::vector<Shown> shown = watched(*room, params, result);
  EXPECT_GE(shown.size(), 3u);
  EXPECT_LE(shown.back().error, 0.1f);
  EXPECT_GT(shown.back().samples, 16);
}

// The judge: 16 times the rays of what is judged, with noise of its own about a fifth as large.
class SlowAdaptive : public testing::Test {
 protected:
  static const Room& room() {
    static const auto instance = lay_out(scene::cornell_box(), 64);
    return *instance;
  }
  static const Gather& judge() {
    static const Gather instance =
        solve(room(), {.samples = 4096, .direct_samples = 1024, .supersample = 64, .seed = 7});
    return instance;
  }
  /// The judge's own noise is a fifth of what it judges at 2 %: it adds two per cent. The claim
  /// is made of 512 texels, which know it to 3 to 5 %.
  static void expect_rms(float max_error) {
    const Gather light = solve(room(), {.samples = 32,
                                        .max_error = max_error,
                                        .error_measure = ErrorMeasure::rms,
                                        .direct_samples = 16,
                                        .supersample = 16});
    double mean = 0, sum2 = 0, judged = 0;
    for (size_t i = 0; i < light.irradiance.size(); ++i) {
      if (light.enclosed[i]) continue;
      const double e = luminance(judge().irradiance[i]);
      const double error = double(luminance(light.irradiance[i])) - e;
      mean += e, sum2 += error * error, judged += 1;
    }
    const double truth = std::sqrt(sum2 * judged) / mean;
    EXPECT_LE(light.relative_error, double(max_error));
    EXPECT_NEAR(light.relative_error, truth, 0.1 * truth);
    EXPECT_GT(truth, 0.8 * double(max_error)) << "rays are dear";
  }
};

// The claim: 95 of 100 texels err by less than `max_error` of their light. Their true errors stay
// below that in the mean over texels, and within twice the estimate at 9 texels of 10 and more. A
// normal error that is known exactly would do so at 19 of 20. The estimate comes from few squares,
// but is rather too large than too small, because halves are less well spread than the whole.
TEST_F(SlowAdaptive, TheErrorIsWhatWasAskedFor) {
  for (const float max_error : {0.05f, 0.02f}) {
    const Gather light = solve(
        room(), {.samples = 32, .max_error = max_error, .direct_samples = 16, .supersample = 16});
    EXPECT_LE(light.error_p95, max_error);
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
  // In this test, for a judge takes as long as all that it judges.
  for (const float max_error : {0.04f, 0.02f}) expect_rms(max_error);
}

}  // namespace
}  // namespace luxel::gather
