#include "luxel/base/exact_predicates.h"

#include <gtest/gtest.h>

#include <cfloat>

#include "luxel/base/random.h"

namespace luxel {
namespace {

__extension__ using Int = __int128;

int sign(Int x) { return (x > 0) - (x < 0); }
int sign(double x) { return (x > 0) - (x < 0); }

/// Number is Int for the truth, for coordinates that are whole multiples of `unit`, or double.
template <class Number>
int orientation_by(double unit, DVec2 a, DVec2 b, DVec2 c) {
  const auto n = [unit](double x) { return Number(x / unit); };
  return sign((n(b.x) - n(a.x)) * (n(c.y) - n(a.y)) - (n(b.y) - n(a.y)) * (n(c.x) - n(a.x)));
}

template <class Number>
int in_circle_by(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  const auto n = [](double x) { return Number(x); };
  const Number ax = n(a.x) - n(d.x), ay = n(a.y) - n(d.y), bx = n(b.x) - n(d.x),
               by = n(b.y) - n(d.y), cx = n(c.x) - n(d.x), cy = n(c.y) - n(d.y);
  return sign((ax * ax + ay * ay) * (bx * cy - by * cx) +
              (bx * bx + by * by) * (cx * ay - cy * ax) +
              (cx * cx + cy * cy) * (ax * by - ay * bx));
}

TEST(ExactPredicates, OrientationOfNeighboursOfALine) {
  // Steps of 2^-53 about (0.5, 0.5), and a line through the origin. [Kettner08]
  const double ulp = std::ldexp(1.0, -53);
  int wrong = 0;
  for (int i = 0; i < 64; ++i)
    for (int k = 0; k < 64; ++k) {
      const DVec2 p{0.5 + i * ulp, 0.5 + k * ulp}, q{12, 12}, r{24, 24};
      const int truth = orientation_by<Int>(ulp, p, q, r);
      ASSERT_EQ(truth, sign(Int(k - i))) << i << " " << k;
      ASSERT_EQ(orientation(p, q, r), truth) << i << " " << k;
      ASSERT_EQ(orientation(r, q, p), -truth) << i << " " << k;
      wrong += orientation_by<double>(1, p, q, r) != truth;
    }
  EXPECT_GT(wrong, 0) << "plain doubles would do here";
}

TEST(ExactPredicates, InCircleOfNeighboursOfACircle) {
  // Whole points on one circle, far from the origin, and their neighbours.
  const std::array<DVec2, 8> on{DVec2{33, 56}, {56, 33},  {63, 16},   {16, 63},
                                {-33, 56},     {25, -60}, {-60, -25}, {39, -52}};
  RandomStream random{1};
  int wrong = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<DVec2, 4> p;
    for (DVec2& q : p) {
      q = on[size_t(random.next() * 8)] * 16381.0;
      q = q + DVec2{1e9 + std::floor(random.next() * 3), -3e9};
    }
    const int truth = in_circle_by<Int>(p[0], p[1], p[2], p[3]);
    ASSERT_EQ(in_circle(p[0], p[1], p[2], p[3]), truth) << trial;
    ASSERT_EQ(in_circle(p[1], p[0], p[2], p[3]), -truth) << trial;
    wrong += in_circle_by<double>(p[0], p[1], p[2], p[3]) != truth;
  }
  EXPECT_GT(wrong, 0) << "plain doubles would do here";
}

TEST(ExactPredicates, TakeTheLargestAndTheSmallestNumbers) {
  const double most = DBL_MAX, least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(orientation({-most, -most}, {most, -most}, {most, most}), 1);
  EXPECT_EQ(orientation({-most, -most}, {most, most}, {0, least}), 1);
  EXPECT_EQ(orientation({-most, -most}, {most, most}, {0, 0}), 0);
  EXPECT_EQ(orientation({0, 0}, {least, 0}, {0, least}), 1);
  EXPECT_EQ(orientation({0, 0}, {least, least}, {2 * least, 2 * least}), 0);
  EXPECT_EQ(in_circle({0, 0}, {least, 0}, {0, least}, {least, least}), 0);
  EXPECT_EQ(in_circle({0, 0}, {least, 0}, {0, least}, {2 * least, least}), -1);
  EXPECT_EQ(in_circle({-most, -most}, {most, -most}, {most, most}, {-most, most}), 0);
  EXPECT_EQ(in_circle({-most, -most}, {most, -most}, {most, most}, {0, least}), 1);
}

TEST(ExactPredicates, LeaveRoundingAsItWas) {
  volatile double one = 1, three = 3;
  const double before = one / three;
  for (int k = 0; k < 3; ++k) EXPECT_EQ(orientation({0.1, 0.1}, {0.3, 0.3}, {0.7, 0.7}), 0);
  EXPECT_EQ(one / three, before);
  EXPECT_EQ(-one / three, -before);
}

}  // namespace
}  // namespace luxel
