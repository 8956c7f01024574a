// Pictures whose luminances are known one by one.
#include "luxel/view/model/histogram.h"

#include <gtest/gtest.h>

#include <numeric>

namespace luxel::view {
namespace {

TEST(Histogram, CountsPixelsByStops) {
  image::Image picture(5, 20, 4);  // 100 pixels of 1, 2, ..., 100, and all grey
  for (int i = 0; i < 100; ++i) {
    const auto v = float(i + 1);
    picture.set_rgb(i % 5, i / 5, {v, v, v});
  }
  const Histogram seen = histogram_of(picture, 1 / 64.0f);
  EXPECT_NEAR(seen.median, 50, 0.51f);
  EXPECT_NEAR(seen.p95, 95, 0.51f);
  EXPECT_NEAR(seen.mean, 50.5f, 1e-3f);
  EXPECT_NEAR(seen.over, 0.36f, 0.011f) << "65 to 100; 64 may be rounded up";
  EXPECT_NEAR(std::accumulate(seen.shares.begin(), seen.shares.end(), 0.0f), 1, 1e-5f);
  // From half of white to white: 33 to 63 or so, in four bins of a quarter stop.
  const auto half = seen.shares.begin() + (-1 - kDarkestStop) * kBinsPerStop;
  EXPECT_NEAR(std::accumulate(half, half + kBinsPerStop, 0.0f), 0.32f, 0.011f);
  EXPECT_NEAR(half[0], 0.06f, 0.011f) << "32 to 38 times 1";
}

TEST(Histogram, LeavesOutBlackAndKeepsWhatIsFarOff) {
  image::Image picture(4, 1, 3);
  for (const float v : histogram_of(picture, 1).shares) EXPECT_EQ(v, 0);
  picture.set_rgb(0, 0, {1e-9f, 1e-9f, 1e-9f});
  picture.set_rgb(1, 0, {1e9f, 1e9f, 1e9f});
  const Histogram seen = histogram_of(picture, 1);
  EXPECT_EQ(seen.shares.front(), 0.5f);
  EXPECT_EQ(seen.shares.back(), 0.5f);
}

}  // namespace
}  // namespace luxel::view
