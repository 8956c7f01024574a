#include "solve/gather/forecast.h"

#include <gtest/gtest.h>

#include "scene/procedural.h"
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

// As many sweeps as are asked for; and of all bounces about as many as bounce() makes, which at 64
// samples are every 4th ray's and then all rays': a sweep's part within a factor of two.
TEST(Forecast, KnowsHowManySweepsFollow) {
  const auto room = lay_out(scene::cornell_box(), 64);
  Progress progress;
  const auto hits = trace_hits(room->scene, room->atlas, room->elements, room->lights.around,
                               *room->tracer, 64, {}, progress);
  ASSERT_TRUE(hits);
  EXPECT_EQ(expected_sweeps(room->map, room->elements, *hits, 64, {3, 1e-4f}), 3);
  const double all = expected_sweeps(room->map, room->elements, *hits, 8, {-1, 1e-4f});
  const std::vector<Rgb> direct(room->elements.size(), {1, 1, 1});
  const auto few = trace_hits(room->scene, room->atlas, room->elements, room->lights.around,
                              *room->tracer, 8, {}, progress);
  const auto bounced = bounce(room->map, room->elements, *few, direct, {}, {-1, 1e-4f}, progress);
  ASSERT_TRUE(bounced);
  EXPECT_LT(all, 2 * bounced->sweeps);
  EXPECT_GT(all, 0.5 * bounced->sweeps);
}

}  // namespace
}  // namespace luxel::gather
