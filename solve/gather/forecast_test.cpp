#include "solve/gather/forecast.h"

#include <gtest/gtest.h>

#include <numeric>

#include "scene/procedural.h"
#include "solve/gather/expected_bounces.h"
#include "solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

transport::TexelScene world_of(const Room& room) {
  return {room.scene, room.atlas, room.map, room.elements, room.lights, *room.tracer};
}

// Seconds are the machine's; rays and stored hits are counted. The trial sees one texel in five of
// the Cornell box: some thousand in squares of 25. Shares of texels that are averaged, and of rays
// that are followed on, differ from square to square: 15 %.
TEST(Forecast, CountsTheRaysAndHitsOfTheWhole) {
  const auto room = lay_out(scene::cornell_box(), 96);
  ASSERT_GT(room->elements.size(), 5000u);
  GatherParams params;
  params.samples = 64, params.direct_samples = 16, params.supersample = 16;
  Progress progress;
  const auto forecast = gather::forecast(world_of(*room), params, 5, progress);
  ASSERT_TRUE(forecast);
  const Gather whole = solve(*room, params);
  EXPECT_NEAR(forecast->rays / double(whole.rays), 1, 0.15);
  const auto hits =
      trace_hits(room->scene, room->atlas, room->elements, room->lights.around, *room->tracer,
                 params.samples, {.near_lights = &room->lights}, progress);
  ASSERT_TRUE(hits);
  EXPECT_NEAR(forecast->hit_bytes / double(hits->bytes_in_memory()), 1, 0.15);
  EXPECT_GT(forecast->direct_s, 0);
  EXPECT_GT(forecast->trace_s, 0);
  EXPECT_GT(forecast->bounces_s, 0);
}

/// Sweeps expected of `tried` texels of a room, and those that bounce() makes of all, with 8
/// samples each: too few for sparse sweeps, whose parts would be counted.
struct Sweeps {
  double expected = 0, made = 0;
};

Sweeps count_sweeps(const Room& room, size_t tried) {
  const size_t n = room.elements.size();
  // Light comes in on a quarter of the room, so that it takes some bounces to get around.
  std::vector<Rgb> direct(n);
  for (size_t i = 0; i < n; ++i)
    if (room.elements.position[i].y < 0.25f) direct[i] = {1, 1, 1};
  const std::vector<uint32_t> some = texels_to_try(room.map, tried);
  std::vector<Rgb> direct_of_some;
  for (const uint32_t i : some) direct_of_some.push_back(direct[i]);
  const BounceParams bounces{.bounces = -1, .tolerance = 1e-4f};
  Progress progress;
  const auto trace = [&](const transport::Elements& elements) {
    return trace_hits(room.scene, room.atlas, elements, room.lights.around, *room.tracer, 8, {},
                      progress);
  };
  const auto few = trace(transport::subset(room.elements, some)), all = trace(room.elements);
  EXPECT_TRUE(few && all);
  const auto expected =
      expected_sweeps(room.map, room.elements, {*few, some, direct_of_some}, 8, bounces);
  const auto made = bounce(room.map, room.elements, *all, direct, {}, bounces, progress);
  EXPECT_TRUE(expected && made);
  return {*expected, double(made->sweeps)};
}

// Light dies away with the largest eigenvalue of the room, which in a room with a bright corner or
// a dark one is not the mean reflectance that rays see. A tenth of the texels tell it within 15 %.
TEST(Forecast, KnowsHowManySweepsFollow) {
  scene::Scene bright = scene::cornell_box();
  for (scene::Material& material : bright.materials) material.base_color = {0.9f, 0.9f, 0.9f};
  for (const scene::Scene& scene : {scene::cornell_box(), bright}) {
    const auto room = lay_out(scene, 96);
    const Sweeps sweeps = count_sweeps(*room, room->elements.size() / 10);
    EXPECT_NEAR(sweeps.expected / sweeps.made, 1, 0.15) << sweeps.made;
  }
}

TEST(Forecast, TakesAsManySweepsAsBouncesAreAskedFor) {
  const auto room = lay_out(scene::cornell_box(), 32);
  Progress progress;
  const auto hits = trace_hits(room->scene, room->atlas, room->elements, room->lights.around,
                               *room->tracer, 8, {}, progress);
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
