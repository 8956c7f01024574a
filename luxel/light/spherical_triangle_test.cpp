#include "luxel/light/spherical_triangle.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"

namespace luxel::light {
namespace {

TEST(SphericalTriangle, AnOctantCoversAnEighthOfTheSphere) {
  const auto t = spherical_triangle({1, 2, 3}, {2, 2, 3}, {1, 3, 3}, {1, 2, 4});
  EXPECT_NEAR(t.solid_angle, kPi / 2, 1e-6f);
}

TEST(SphericalTriangle, ASmallFarTriangleCoversAreaOverDistanceSquared) {
  const float h = 1e-3f;
  const auto t = spherical_triangle({0, 0, 0}, {0, 0, 1}, {h, 0, 1}, {0, h, 1});
  EXPECT_NEAR(t.solid_angle / (0.5f * h * h), 1, 1e-3f);
}

TEST(SphericalTriangle, InvertUndoesSample) {
  RandomStream random{7};
  for (int k = 0; k < 200; ++k) {
    const auto corner = [&] {
      return Vec3{random.next() - 0.5f, random.next() - 0.5f, 0.3f + random.next()};
    };
    const auto t = spherical_triangle({}, corner(), corner(), corner());
    if (t.solid_angle < 1e-2f) continue;
    const Vec2 u{0.05f + 0.9f * random.next(), 0.05f + 0.9f * random.next()};
    const Vec2 back = spherical_triangle_invert(t, spherical_triangle_sample(t, u));
    // Float rounding in acos-like steps: about sqrt(2^-24) near degenerate shapes.
    EXPECT_NEAR(back.x, u.x, 5e-3f) << "triangle " << k;
    EXPECT_NEAR(back.y, u.y, 5e-3f) << "triangle " << k;
  }
}

// The mean direction over a spherical triangle has a closed form, Lambert's edge sum: with density
// 1/Omega, E[d] = 1/(2 Omega) sum_k gamma_k (r_k x r_k+1)/|...|. It fixes the density, not only
// the support.
TEST(SphericalTriangle, SamplesHaveTheMeanOfTheUniformDensity) {
  const Vec3 a{1, 0.2f, 0.1f}, b{-0.3f, 0.9f, 0.4f}, c{0.1f, 0.2f, 1};
  const auto t = spherical_triangle({}, a, b, c);
  const Vec3 r[3] = {t.a, t.b, t.c};
  Vec3 exact{};
  for (int k = 0; k < 3; ++k) {
    const Vec3 n = cross(r[k], r[(k + 1) % 3]);
    exact +=
        normalize(n) * (std::atan2(length(n), dot(r[k], r[(k + 1) % 3])) / (2 * t.solid_angle));
  }
  Vec3 mean{};
  const int n = 4096;
  for (int i = 0; i < n; ++i)
    mean += spherical_triangle_sample(t, sobol_owen_2d(uint32_t(i), 3)) / float(n);
  // A scrambled net of 4096 points errs by about n^-1.5 = 4e-6 on a smooth function; float adds
  // 1e-5.
  EXPECT_NEAR(mean.x, exact.x, 1e-4f);
  EXPECT_NEAR(mean.y, exact.y, 1e-4f);
  EXPECT_NEAR(mean.z, exact.z, 1e-4f);
}

}  // namespace
}  // namespace luxel::light
