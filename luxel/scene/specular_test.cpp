#include "luxel/scene/specular.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxel::scene {
namespace {

TEST(Specular, RoughnessAndSharpnessAreInverse) {
  for (const float n : {1.0f, 7.5f, 40.0f, 1000.0f})
    EXPECT_NEAR(sharpness_of(roughness_of(n)), n, 1e-4f * n);
  EXPECT_FLOAT_EQ(sharpness_of(0.5f), 7.5f);
  EXPECT_EQ(sharpness_of(1), 1) << "clamped: an exponent of 0 would be no highlight at all";
  EXPECT_EQ(sharpness_of(0), 10000) << "clamped: a mirror shows nothing here";
}

// For light along the normal the paper's term, radiance per irradiance C_s / pi (R.V)^n, summed
// over the hemisphere of eyes is F0.
TEST(Specular, TheLobeReflectsF0) {
  for (const float n : {1.0f, 7.5f, 40.0f}) {
    const Rgb c = specular_of({0.04f, 0.02f, 0.01f}, n);
    double integral = 0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const double theta = (i + 0.5) * 0.5 * 3.14159265358979 / steps;
      integral += std::pow(std::cos(theta), double(n)) * std::sin(theta) * 2 * 3.14159265358979;
    }
    integral *= 0.5 * 3.14159265358979 / steps;
    EXPECT_NEAR(double(c.x) / 3.14159265358979 * integral, 0.04, 1e-5);
    EXPECT_NEAR(f0_of(c, n).z, 0.01f, 1e-6f);
  }
  EXPECT_EQ(specular_of({0.5f, 0.5f, 0.5f}, 1000), (Rgb{1, 1, 1}));
}

}  // namespace
}  // namespace luxel::scene
