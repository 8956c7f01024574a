#include "luxel/base/circle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"

namespace luxel {
namespace {

// Tolerances: terms that the series omit, and roundings of 6e-8 times 1 (points) or pi (angles).
TEST(Circle, PointsAreThoseOfSineAndCosine) {
  RandomStream random{1};
  for (int k = 0; k < 100000; ++k) {
    const float x = k < 4 ? 0.25f * float(k) : random.next();
    const double phi = 2 * M_PI * double(x);
    const Vec2 p = unit_circle(x);
    EXPECT_NEAR(double(p.x), std::cos(phi), 4e-7);
    EXPECT_NEAR(double(p.y), std::sin(phi), 4e-7);
  }
}

TEST(Circle, AnglesAreThoseOfTheArcTangent) {
  RandomStream random{2};
  for (int k = 0; k < 100000; ++k) {
    const float scale = std::pow(10.0f, 20 * random.next() - 10);
    const float x = scale * (2 * random.next() - 1), y = scale * (2 * random.next() - 1);
    EXPECT_NEAR(double(angle_of(y, x)), std::atan2(double(y), double(x)), 4e-7);
  }
  for (const float x : {-1.0f, 0.0f, 1.0f})
    for (const float y : {-1.0f, 0.0f, 1.0f})
      EXPECT_NEAR(double(angle_of(y, x)), std::atan2(double(y), double(x)), 4e-7) << y << " " << x;
}

}  // namespace
}  // namespace luxel
