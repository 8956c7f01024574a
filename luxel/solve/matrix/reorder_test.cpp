#include "luxel/solve/matrix/reorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::matrix {
namespace {

const Progress kProgress;

TEST(GreedyOrder, GoesAlongALine) {
  // Places on a line, spread by 37 k mod 101, the first at its end.
  std::vector<float> points;
  for (int k = 0; k < 101; ++k) {
    const auto at = float(37 * k % 101);
    points.insert(points.end(), {at, 2 * at, -at});
  }
  const std::vector<uint32_t> order = greedy_order(points, 3, kProgress);
  ASSERT_EQ(order.size(), 101u);
  for (size_t k = 0; k < order.size(); ++k) EXPECT_EQ(points[3 * order[k]], float(k));
}

TEST(GreedyOrder, GoesToTheNearestOfWhatIsLeft) {
  // By hand: from 0 to 1 (distance 1), then -2 (3) rather than 5 (4), then 5.
  EXPECT_THAT(greedy_order(std::vector<float>{0, 5, 1, -2}, 1, kProgress),
              ::testing::ElementsAre(0, 2, 3, 1));
  // Among equally near ones the first wins.
  EXPECT_THAT(greedy_order(std::vector<float>{0, 1, -1, 1}, 1, kProgress),
              ::testing::ElementsAre(0, 1, 3, 2));
  EXPECT_THAT(greedy_order(std::vector<float>{}, 1, kProgress), ::testing::IsEmpty());
}

std::vector<uint8_t> random_picture(size_t pixels) {
  std::vector<uint8_t> out(4 * pixels);
  for (size_t k = 0; k < out.size(); ++k) out[k] = uint8_t(hash64(3, k));
  return out;
}

TEST(Project, KeepsDistances) {
  const size_t count = 30, length = 700;
  const std::vector<uint8_t> picture = random_picture(count * length);
  const std::vector<float> points = project({picture.data(), count, length, length, 1}, kProgress);
  double mean = 0, pairs = 0;
  for (size_t a = 0; a < count; ++a)
    for (size_t b = 0; b < a; ++b) {
      double want = 0, got = 0;
      for (size_t k = 0; k < 4 * length; ++k)
        if (k % 4 != 3)
          want += std::pow(picture[4 * a * length + k] - picture[4 * b * length + k], 2);
      for (size_t d = 0; d < kProjected; ++d)
        got += std::pow(double(points[a * kProjected + d] - points[b * kProjected + d]), 2);
      const double ratio = got / (kProjected * want);
      // sqrt(2 / 128) = 0.125 is the standard deviation; five of them.
      EXPECT_NEAR(ratio, 1, 0.63);
      mean += ratio, ++pairs;
    }
  // 435 pairs share 128 dimensions: their mean is off by less than one of them.
  EXPECT_NEAR(mean / pairs, 1, 0.06);
}

TEST(Project, ColumnsAreTheRowsOfTheTransposed) {
  const size_t count = 23, length = 50;
  const std::vector<uint8_t> picture = random_picture(count * length);
  std::vector<uint8_t> turned(picture.size());
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j < length; ++j)
      std::copy_n(picture.data() + 4 * (i * length + j), 4, turned.data() + 4 * (j * count + i));
  EXPECT_EQ(project({picture.data(), count, length, length, 1}, kProgress),
            project({turned.data(), count, length, 1, count}, kProgress));
}

TEST(Project, SameBitsForAnyNumberOfThreads) {
  const std::vector<uint8_t> picture = random_picture(40 * 60);
  const auto points = [&](int threads) {
    const ThreadLimit limit(threads);
    return project({picture.data(), 40, 60, 60, 1}, kProgress);
  };
  const std::vector<float> one = points(1);
  EXPECT_EQ(one, points(2));
  EXPECT_EQ(one, points(7));
}

}  // namespace
}  // namespace luxel::matrix
