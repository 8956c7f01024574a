#include "luxel/base/warp.h"

#include <gtest/gtest.h>

#include <vector>

#include "luxel/base/random.h"

namespace luxel {
namespace {

TEST(CosineHemisphere, InvertUndoesSample) {
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vec2 u{(float(i) + 0.5f) / 64, (float(j) + 0.5f) / 64};
      const Vec3 d = cosine_hemisphere_sample(u);
      EXPECT_NEAR(length(d), 1, 1e-6);
      EXPECT_GE(d.z, 0);
      const Vec2 back = cosine_hemisphere_invert(d);
      EXPECT_NEAR(back.x, u.x, 1e-5);
      EXPECT_NEAR(back.y, u.y, 1e-5);
    }
}

// The mean of the uniform distribution is 0 and E[d d^T] = 1 / 3. A mean over a grid of midpoints
// of 256 squared errs by its cells' squares, 1e-5; float adds 1e-6.
TEST(UniformSphere, HasTheMomentsOfTheSphere) {
  constexpr int kSide = 256;
  double first[3] = {}, second[3][3] = {};
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vec3 d = uniform_sphere_sample({(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide});
      const double v[3] = {double(d.x), double(d.y), double(d.z)};
      for (int a = 0; a < 3; ++a) {
        first[a] += v[a] / (kSide * kSide);
        for (int b = 0; b < 3; ++b) second[a][b] += v[a] * v[b] / (kSide * kSide);
      }
    }
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(first[a], 0, 2e-5);
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(second[a][b], a == b ? 1.0 / 3 : 0, 2e-5);
  }
}

// The chance of a bin, from the density alone, integrated by the midpoint rule over cos(theta) and
// phi (solid angle = d cos d phi), against the share of samples in it. A bin with chance p holds
// n p samples with a standard deviation of at most sqrt(n p); five of those, for 80 bins, give a
// false alarm once in 20,000 seeds, and the seed is fixed.
TEST(CosineHemisphere, HistogramFollowsTheDensity) {
  constexpr int kCos = 10, kPhi = 8, kSamples = 1 << 17, kSteps = 64;
  std::vector<double> share(kCos * kPhi);
  RandomStream random{5};
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 d = cosine_hemisphere_sample(random.next2());
    const float turn = std::atan2(d.y, d.x) / (2 * kPi);
    const int c = std::min(kCos - 1, int(d.z * kCos));
    const int p = std::min(kPhi - 1, int((turn < 0 ? turn + 1 : turn) * kPhi));
    share[size_t(c * kPhi + p)] += 1.0 / kSamples;
  }
  double total = 0;
  for (int c = 0; c < kCos; ++c) {
    double chance = 0;
    for (int s = 0; s < kSteps; ++s)
      chance += double(cosine_hemisphere_pdf_solid_angle((float(c) + (float(s) + 0.5f) / kSteps) /
                                                         kCos)) *
                (1.0 / kCos / kSteps) * (2 * M_PI / kPhi);
    for (int p = 0; p < kPhi; ++p)
      EXPECT_NEAR(share[size_t(c * kPhi + p)], chance, 5 * std::sqrt(chance / kSamples));
    total += chance * kPhi;
  }
  EXPECT_NEAR(total, 1, 1e-6);
  EXPECT_EQ(cosine_hemisphere_pdf_solid_angle(-0.5f), 0);
}

// All corners of the unit square, and the seam at phi = 0, are inside.
TEST(CosineHemisphere, EdgesOfTheSquareAreSafe) {
  for (const float x : {0.0f, 0.5f, 0x1.fffffep-1f})
    for (const float y : {0.0f, 0.5f, 0x1.fffffep-1f}) {
      const Vec3 d = cosine_hemisphere_sample({x, y});
      EXPECT_TRUE(is_finite(d));
      EXPECT_GE(d.z, 0);
      const Vec2 u = cosine_hemisphere_invert(d);
      EXPECT_TRUE(u.x >= 0 && u.x <= 1 && u.y >= 0 && u.y <= 1.000001f);
    }
}

// Uniform on the triangle: each of the 100 congruent small triangles holds its share of 1/100. The
// bound is that of the histogram above.
TEST(TriangleSample, IsUniform) {
  constexpr int kSide = 10, kSamples = 1 << 16;
  std::vector<int> count(2 * kSide * kSide);
  RandomStream random{6};
  for (int i = 0; i < kSamples; ++i) {
    const Barycentric b = triangle_sample(random.next2());
    ASSERT_GE(b.u, 0);
    ASSERT_GE(b.v, 0);
    ASSERT_LE(b.u + b.v, 1.000001f);
    const float x = b.u * kSide, y = b.v * kSide;
    const int column = std::min(int(x), kSide - 1), row = std::min(int(y), kSide - 1);
    const bool upper = x - float(column) + y - float(row) > 1;
    ++count[size_t(2 * (row * kSide + column) + upper)];
  }
  const double expected = double(kSamples) / (kSide * kSide);
  int used = 0;
  for (const int n : count) {
    if (n == 0) continue;
    ++used;
    EXPECT_NEAR(n, expected, 5 * std::sqrt(expected));
  }
  EXPECT_EQ(used, kSide * kSide);
  EXPECT_EQ(triangle_pdf_area(0.25f), 4);
}

TEST(TriangleSample, IsContinuousAcrossTheDiagonal) {
  for (int i = 1; i < 100; ++i) {
    const float t = float(i) / 100;
    const Barycentric a = triangle_sample({t, t + 1e-6f}), b = triangle_sample({t, t - 1e-6f});
    EXPECT_NEAR(a.u, b.u, 1e-5);
    EXPECT_NEAR(a.v, b.v, 1e-5);
  }
}

}  // namespace
}  // namespace luxel
