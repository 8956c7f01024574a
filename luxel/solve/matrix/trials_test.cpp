#include "luxel/solve/matrix/trials.h"

#include <cmath>

#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using namespace testing;

constexpr float kReflectance = 0.6f;

/// The inside of a sphere with its exact factors.
struct Sphere {
  Cut cut{scene::inward_sphere(1, 3, {kReflectance, kReflectance, kReflectance}, {}), 300};
  Prepared prepared;
  CoarseScene coarse;
  Trials trials;

  Sphere() {
    Progress progress;
    prepared.patched = std::move(cut.patched);
    const Patches& patches = prepared.patched.patches;
    prepared.factors = sphere_factors(patches.area_m2);
    coarse = make_coarse_scene(prepared.factors, prepared.patched.tree, patches.area_m2,
                               patches.elements.reflectance, 16);
    auto made = make_trials(cut.scene, cut.tracer, prepared, coarse,
                            {.in_the_open = 3, .anywhere = 0}, progress);
    EXPECT_TRUE(made);
    if (made) trials = std::move(*made);
  }
};

// Irradiance is the same everywhere: E = (sum A B / A) / (1 - rho) for all bounces.
TEST(MatrixTrials, LightOfASphereIsItsMeanOverWhatIsLost) {
  const Sphere sphere;
  const Patches& patches = sphere.prepared.patched.patches;
  ASSERT_EQ(sphere.trials.sent.size(), 3u);
  for (size_t t = 0; t < 3; ++t) {
    double sent = 0;
    for (size_t i = 0; i < patches.size(); ++i)
      sent += double(patches.area_m2[i]) * double(sphere.trials.sent[t][i].y);
    const double want = sent / sum_of(patches.area_m2) / (1 - double(kReflectance));
    ASSERT_GT(want, 0);
    // Sums of 300 floats.
    for (const Rgb e : sphere.trials.irradiance[t]) ASSERT_NEAR(double(e.y), want, 1e-5 * want);
  }
}

// E_k = (1 - rho^k) E: the error of k products is rho^k.
TEST(MatrixTrials, ErrorOfProductsOnASphereIsAPowerOfItsReflectance) {
  const Sphere sphere;
  const std::vector<double> errors = errors_of_products(sphere.prepared, sphere.trials, 8);
  ASSERT_EQ(errors.size(), 8u);
  // The rounding of E, relative to E.
  for (size_t k = 0; k < errors.size(); ++k)
    EXPECT_NEAR(errors[k], std::pow(double(kReflectance), double(k + 1)), 1e-5) << k;
}

// Clusters see what patches see on a sphere, so that two sweeps, the fewest, are exact.
TEST(MatrixTrials, TwoSweepsAreEnoughForASphere) {
  const Sphere sphere;
  EXPECT_EQ(enough_sweeps(sphere.trials, 1e-5), 2);
}

// After one sweep one bounce is there, and 1 - rho of the light; after two all of it is.
TEST(MatrixTrials, ErrorOfOneSweepOnASphereIsItsReflectance) {
  const Sphere sphere;
  ASSERT_GE(sphere.trials.error_of_sweeps.size(), 2u);
  for (size_t t = 0; t < 3; ++t) {
    EXPECT_NEAR(sphere.trials.error_of_sweeps[0][t], double(kReflectance), 1e-5);
    EXPECT_LT(sphere.trials.error_of_sweeps[1][t], 1e-5);
  }
}

// Half the factors, and one bounce: half the light.
TEST(MatrixTrials, CodecThatHalvesLightErrsByHalf) {
  const Sphere sphere;
  const Patches& patches = sphere.prepared.patched.patches;
  Progress progress;
  const auto trials =
      make_trials(sphere.cut.scene, sphere.cut.tracer, sphere.prepared, sphere.coarse,
                  {.in_the_open = 3, .anywhere = 0, .bounces = 1}, progress);
  ASSERT_TRUE(trials);
  FormFactors half = sphere.prepared.factors;
  for (float& f : half.factor) f *= 0.5f;
  const Codec whole = DenseCodec{make_dense(sphere.prepared.factors, Precision::single), {}, 2};
  const Codec halved = DenseCodec{make_dense(half, Precision::single), {}, 2};
  // Sums of 300 floats in another order.
  for (const double e : errors_of(whole, *trials, patches, 1)) EXPECT_LT(e, 1e-5);
  for (const double e : errors_of(halved, *trials, patches, 1)) EXPECT_NEAR(e, 0.5, 1e-5);
}

}  // namespace
}  // namespace luxel::matrix
