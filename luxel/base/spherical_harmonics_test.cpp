#include "luxel/base/spherical_harmonics.h"

#include <gtest/gtest.h>

#include "luxel/base/vec_double.h"

namespace luxel {
namespace {

TEST(SphericalHarmonics, AreOrthonormal) {
  constexpr uint32_t kDirections = 20000;
  std::array<std::array<double, kSh2>, kSh2> sum{};
  for (uint32_t i = 0; i < kDirections; ++i) {
    const auto y = sh2_basis(spiral_direction(i, kDirections));
    for (size_t k = 0; k < kSh2; ++k)
      for (size_t l = 0; l < kSh2; ++l)
        sum[k][l] += double(y[k]) * double(y[l]) * 4 * kPiDouble / kDirections;
  }
  // Products of degree four over an even spiral: far below 1e-5 of the sphere's 4 pi.
  for (size_t k = 0; k < kSh2; ++k)
    for (size_t l = 0; l < kSh2; ++l) EXPECT_NEAR(sum[k][l], k == l ? 1 : 0, 2e-4) << k << l;
}

// max(0, n . d) of a lamp in direction d: pi Y_0 Y_0(d) + ..., the best that two bands can do,
// which is 1.0625 of what it should be where n = d and never off by more than that.
TEST(SphericalHarmonics, HoldACosineLobe) {
  const Vec3 lamp = normalize(Vec3{0.3f, -0.5f, 0.8f});
  const auto y = sh2_basis(lamp);
  std::array<Rgb, kSh2> c;
  for (size_t k = 0; k < kSh2; ++k)
    c[k] = Rgb{1, 2, 0} * (y[k] * (k == 0 ? kPi : k < 4 ? 2 * kPi / 3 : kPi / 4));
  EXPECT_NEAR(sh2_value(c, lamp).x, 1 / 4.0 + 1 / 2.0 + 5 / 16.0, 1e-5);
  EXPECT_NEAR(sh2_value(c, lamp).y, 2 * (1 / 4.0 + 1 / 2.0 + 5 / 16.0), 1e-5);
  EXPECT_NEAR(sh2_value(c, -lamp).x, 1 / 4.0 - 1 / 2.0 + 5 / 16.0, 1e-5);
}

}  // namespace
}  // namespace luxel
