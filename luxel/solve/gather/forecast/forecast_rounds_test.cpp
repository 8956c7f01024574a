#include "luxel/solve/gather/forecast/forecast_rounds.h"

#include <gtest/gtest.h>

#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

/// Rays that come after the first round: by the forecast over those of gather().
double planned_over_real(const Room& room, float max_error, int part) {
  GatherParams params = with_samples(32, 16);
  params.supersample = 16;
  const double first = double(solve(room, params).rays);
  params.max_error = max_error;
  const double real = double(solve(room, params).rays) - first;
  Progress progress;
  const auto planned = forecast_rounds(scene_of(room), params, {}, part, progress);
  EXPECT_TRUE(planned);
  EXPECT_GT(real, first) << "the rounds are what it is about";
  return planned->rays / real;
}

// All texels are tried: they differ by the light that they see, which is coarse but has less noise
// than that of the first round, and by rounds that one texel in twenty decides about: 10 %.
TEST(ForecastRounds, AreThoseOfTheBake) {
  const auto room = lay_out(scene::cornell_box(), 48);
  EXPECT_NEAR(planned_over_real(*room, 0.05f, 1), 1, 0.1);
}

// One texel in four, in cells: how light varies from cell to cell adds to that; 20 %.
TEST(SlowForecastRounds, AreKnownFromSomeTexels) {
  const auto room = lay_out(scene::cornell_box(), 160);
  ASSERT_GT(room->elements.size(), 4 * kFewestTried);
  for (const float max_error : {0.05f, 0.03f})
    EXPECT_NEAR(planned_over_real(*room, max_error, 4), 1, 0.2) << max_error;
}

// An error that the first round has reached needs nothing but the last bounces.
TEST(ForecastRounds, AreNoneWhereNoneAreNeeded) {
  const auto room = lay_out(scene::cornell_box(), 24);
  GatherParams params = with_samples(32, 16);
  params.max_error = 1;
  Progress progress;
  const auto planned = forecast_rounds(scene_of(*room), params, {}, 1, progress);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->rays, 0);
  EXPECT_EQ(planned->hit_bytes, 0);
  EXPECT_GT(planned->bounces_s, 0);
}

TEST(ForecastRounds, CanBeStopped) {
  const auto room = lay_out(scene::cornell_box(), 24);
  GatherParams params = with_samples(32, 16);
  params.max_error = 0.01f;
  Progress progress;
  progress.request_cancel();
  const auto planned = forecast_rounds(scene_of(*room), params, {}, 1, progress);
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::gather
