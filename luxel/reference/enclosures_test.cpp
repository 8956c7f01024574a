// Furnaces: shared/reference/exact-solutions.md, section 1. The other sections are compared, by
// every solver, in tests/agreement/exact_test.cpp.
#include "luxel/reference/path_tracer.h"

#include <gtest/gtest.h>

#include "luxel/reference/reference_test_support.h"
#include "luxel/scene/procedural.h"

namespace luxel::reference {
namespace {

using namespace testing;

/// Emission that makes self-emitted radiosity e.
constexpr Rgb exitance(float e) { return gray(e / kPi); }

// Section 1: B = e / (1 - rho), so E = pi L / (1 - rho), at every point and in every channel.
TEST(Enclosures, AFurnaceIsUniform) {
  for (const float rho : {0.0f, 0.5f, 0.9f}) {
    const scene::Scene scene = scene::furnace_box(gray(rho), {1, 2, 0.5f});
    const Points points = random_points(scene, 200, 1);
    const TexelPaths result = solve(scene, points, {.samples = 300});
    const double expected = double(kPi) / (1 - double(rho));
    expect_unbiased(result, std::vector<double>(points.size(), expected));
    for (size_t i = 0; i < points.size(); ++i) {
      // All channels follow the same paths.
      EXPECT_NEAR(result.irradiance[i].y, 2 * result.irradiance[i].x, 1e-4 * expected);
      EXPECT_NEAR(result.irradiance[i].z, 0.5f * result.irradiance[i].x, 1e-4 * expected);
    }
  }
}

// Section 1, bounce by bounce: E_k = e (1 - rho^(k+1)) / (1 - rho).
TEST(Enclosures, EveryBounceOfAFurnaceIsCounted) {
  for (const auto& [rho, e] : {std::pair{0.5f, 1.0f}, {0.9f, 0.3f}}) {
    const scene::Scene scene = scene::furnace_box(gray(rho), exitance(e));
    const Points points = random_points(scene, 100, 2);
    // Beyond the eighth bounce roulette ends paths; it must not change the mean.
    for (const int k : {0, 1, 2, 5, 8, 9, 12, 30}) {
      const TexelPaths result = solve(scene, points, {.samples = 300, .bounces = k});
      const double expected = double(e) * (1 - std::pow(double(rho), k + 1)) / (1 - double(rho));
      expect_unbiased(result, std::vector<double>(points.size(), expected));
    }
  }
}

}  // namespace
}  // namespace luxel::reference
