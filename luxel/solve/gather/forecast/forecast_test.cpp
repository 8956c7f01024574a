#include "luxel/solve/gather/forecast/forecast.h"

#include <gtest/gtest.h>

#include <numeric>

#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/forecast/expected_bounces.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

// Seconds are the machine's; rays and stored hits are counted. The trial sees one texel in five of
// the Cornell box: some thousand in squares of 25. Shares of texels that are averaged, and of rays
// that are followed on, differ from square to square: 15 %.
TEST(Forecast, CountsTheRaysAndHitsOfTheWhole) {
  const auto room = lay_out(scene::cornell_box(), 96);
  ASSERT_GT(room->elements.size(), 5000u);
  GatherParams params;
  params.samples = 64, params.direct_samples = 16, params.supersample = 16;
  Progress progress;
  const auto forecast = gather::forecast(scene_of(*room), params, {}, {.part = 5}, progress);
  ASSERT_TRUE(forecast);
  const Gather whole = solve(*room, params);
  EXPECT_NEAR(forecast->rays / double(whole.rays), 1, 0.15);
  const auto hits =
      trace_hits(trace_scene(scene_of(*room)), params.samples, {.follows_near = true}, progress);
  ASSERT_TRUE(hits);
  EXPECT_NEAR(forecast->hit_bytes / double(hits->bytes_in_memory()), 1, 0.15);
  EXPECT_GT(forecast->direct_s, 0);
  EXPECT_GT(forecast->supersample_s, 0);
  EXPECT_GT(forecast->trace_s, 0);
  EXPECT_GT(forecast->bounces_s, 0);
}

/// Sweeps expected of a tenth of a room's texels, and those that bounce() makes of all, over all
/// their rays.
struct Sweeps {
  double expected = 0, made = 0;
};

/// Traces in so many rounds, each of as many rays as all before.
Result<TracedHits> trace(const Room& room, const transport::Elements& elements, int samples,
                         int rounds) {
  Progress progress;
  TracedHits hits = no_hits(elements.size());
  for (int r = rounds - 1; r >= 0; --r) {
    const std::vector<uint16_t> target(elements.size(), uint16_t(samples >> r));
    LUXEL_TRY_STATUS(trace_more({room.scene, room.atlas, elements, room.lights, *room.tracer},
                                target, {}, hits, progress));
  }
  return hits;
}

Result<Sweeps> count_sweeps(const Room& room, int rounds) {
  constexpr int kSamples = 32;  // too few for sparse sweeps, whose parts would be counted
  const size_t n = room.elements.size();
  // Light comes in low, so that it takes some bounces to get around.
  std::vector<Rgb> direct(n), direct_of_some;
  for (size_t i = 0; i < n; ++i)
    if (room.elements.position[i].y < 0.25f) direct[i] = {1, 1, 1};
  const std::vector<uint32_t> some = texels_to_try(room.map, n / 10);
  for (const uint32_t i : some) direct_of_some.push_back(direct[i]);
  const BounceParams bounces{.bounces = -1, .tolerance = 1e-4f};
  LUXEL_TRY(const TracedHits few,
            trace(room, transport::subset(room.elements, some), kSamples, rounds));
  LUXEL_TRY(const TracedHits all, trace(room, room.elements, kSamples, 1));
  LUXEL_TRY(const double expected, expected_sweeps(room.map, room.elements,
                                                   {few, some, direct_of_some}, kSamples, bounces));
  Progress progress;
  LUXEL_TRY(const Bounced made,
            bounce(room.map, room.elements, all, direct, {}, bounces, progress));
  return Sweeps{expected, double(made.sweeps)};
}

scene::Scene room_of(Rgb reflectance) {
  scene::Scene scene = scene::cornell_box();
  for (scene::Material& material : scene.materials) material.base_color = reflectance;
  return scene;
}

// Light dies away with the largest eigenvalue of the room, in its brightest colour, and not with
// the mean reflectance that rays see. A tenth of the texels tell it within 15 %. The white room
// needs more sweeps than are made of the trial.
TEST(Forecast, KnowsHowManySweepsFollow) {
  for (const scene::Scene& scene : {scene::cornell_box(), room_of({0.9f, 0.9f, 0.9f}),
                                    room_of({0.1f, 0.1f, 0.8f}), room_of({0.98f, 0.98f, 0.98f})})
    for (const int rounds : {1, 4}) {
      const auto room = lay_out(scene, 96);
      const Result<Sweeps> sweeps = count_sweeps(*room, rounds);
      ASSERT_TRUE(sweeps);
      EXPECT_NEAR(sweeps->expected / sweeps->made, 1, 0.15) << sweeps->made;
    }
}

TEST(Forecast, TakesAsManySweepsAsBouncesAreAskedFor) {
  const auto room = lay_out(scene::cornell_box(), 32);
  const auto hits = trace(*room, room->elements, 8, 1);
  ASSERT_TRUE(hits);
  const std::vector<Rgb> direct(room->elements.size(), {1, 1, 1});
  std::vector<uint32_t> all(direct.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto sweeps =
      expected_sweeps(room->map, room->elements, {*hits, all, direct}, 8, {.bounces = 3});
  ASSERT_TRUE(sweeps);
  EXPECT_EQ(*sweeps, 3);
}

}  // namespace
}  // namespace luxel::gather
