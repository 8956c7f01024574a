#include "luxel/light/surroundings.h"

#include <gtest/gtest.h>

#include "luxel/base/vec_double.h"
#include "luxel/base/warp.h"

namespace luxel::light {
namespace {

/// A blue gradient with a yellow sun of three pixels, and one red pixel just below the horizon.
scene::Scene sky_with_sun() {
  scene::Scene scene;
  scene::Environment& map = scene.environment;
  map.width = 64, map.height = 32, map.rotation_rad = 1;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      map.radiance.push_back(Rgb{0.2f, 0.4f, 1} * (1 - float(y) / 40));
  map.radiance[6 * 64 + 20] = map.radiance[6 * 64 + 21] = {9000, 8000, 5000};
  map.radiance[7 * 64 + 20] = {3000, 2500, 2000};
  map.radiance[17 * 64 + 50] = {700, 0, 0};
  return scene;
}

/// The integral of L f over the sphere, by 16 x 16 points in each pixel.
template <class F>
Rgb integral(const scene::Environment& map, const F& f) {
  double r = 0, g = 0, b = 0;
  constexpr int n = 16;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      for (int k = 0; k < n * n; ++k) {
        const Vec3 d = scene::direction_of(map, {(float(x) + (float(k % n) + 0.5f) / n) / 64,
                                                 (float(y) + (float(k / n) + 0.5f) / n) / 32});
        const double theta = kPiDouble * (y + (k / n + 0.5) / n) / map.height;
        const double omega =
            2 * kPiDouble * kPiDouble * std::sin(theta) / (double(map.width) * map.height * n * n);
        const Rgb l = f(map.radiance[size_t(y) * 64 + size_t(x)], d);
        r += double(l.x) * omega, g += double(l.y) * omega, b += double(l.z) * omega;
      }
  return {float(r), float(g), float(b)};
}

TEST(Surroundings, LayersSumToTheMap) {
  const scene::Scene scene = sky_with_sun();
  const Surroundings s = surroundings_of(scene);
  EXPECT_EQ(s.bright_texels.size(), 4u);
  const auto up = [](Rgb l, Vec3 d) { return l * std::max(0.0f, d.y); };
  const Rgb whole = integral(scene.environment, up);
  Rgb sum =
      integral(scene.environment, [&](Rgb, Vec3 d) { return up(soft_radiance(scene, s, d), d); });
  constexpr uint32_t kSamples = 4096;
  for (uint32_t k = 0; k < kSamples; ++k) {
    const BrightTexelSample p = sample_bright_texels(scene, s, sobol_owen_2d(k, 3));
    sum += up(p.radiance_over_pdf, p.direction) / float(kSamples);
  }
  // Samples are shared out over the four pixels to one in 4,096, of a sun that brings nearly all.
  EXPECT_NEAR(sum.x / whole.x, 1, 1e-3);
  EXPECT_NEAR(sum.y / whole.y, 1, 1e-3);
  EXPECT_NEAR(sum.z / whole.z, 1, 1e-3);
}

// The soft layer keeps the colour and ends at the limit.
TEST(Surroundings, SoftLightEndsAtTheLimit) {
  const scene::Scene scene = sky_with_sun();
  const Surroundings s = surroundings_of(scene);
  const Vec3 sun = scene::direction_of(scene.environment, {20.5f / 64, 6.5f / 32});
  const Rgb soft = soft_radiance(scene, s, sun);
  EXPECT_NEAR(luminance(soft), s.limit, 1e-5f * s.limit);
  EXPECT_NEAR(soft.x / soft.z, 9000.0f / 5000, 1e-5f);
  // Four times a mean that lies within the gradient's luminances, 0.02 to 0.4.
  EXPECT_GT(s.limit, 4 * 0.2f * 0.4f);
  EXPECT_LT(s.limit, 4 * 0.5f);
}

TEST(Surroundings, AMapOfOneColourHasNoBrightTexels) {
  scene::Scene scene;
  scene.environment = {8, 4, std::vector<Rgb>(32, {3, 3, 3}), 0};
  scene.background = {1, 0, 0};
  const Surroundings s = surroundings_of(scene);
  EXPECT_TRUE(s.bright_texels.empty());
  EXPECT_EQ(soft_radiance(scene, s, {0, 1, 0}), (Rgb{4, 3, 3}));
}

// A black map: no light, no division by it.
TEST(Surroundings, ABlackMapIsDark) {
  scene::Scene scene;
  scene.environment = {8, 4, std::vector<Rgb>(32), 0};
  const Surroundings s = surroundings_of(scene);
  EXPECT_TRUE(s.bright_texels.empty());
  EXPECT_EQ(soft_radiance(scene, s, {1, 0, 0}), (Rgb{}));
}

TEST(Surroundings, FoldingKeepsTheIntegralOfTheCosine) {
  const Vec3 normal = normalize(Vec3{0.6f, 1, -0.3f}), up{0, 1, 0};
  double sum = 0;
  constexpr uint32_t kSamples = 1 << 16;
  for (uint32_t k = 0; k < kSamples; ++k) {
    const Vec3 d = uniform_sphere_sample(sobol_owen_2d(k, 1));
    if (d.y > 0) sum += double(folded_cosine(d, normal, up));
  }
  // A (0, 16, 2)-net on a function with kinks: far below 1e-3.
  EXPECT_NEAR(sum * 4 * kPiDouble / kSamples, kPiDouble, 1e-3);
}

// The guide leads to the same bright texel as a search through all: shares of what they bring are
// those of their power, for which each must be met by just its part of u.
TEST(Surroundings, BrightTexelsAreMetByTheirPower) {
  scene::Scene scene;
  scene::Environment& map = scene.environment;
  map = {64, 32, std::vector<Rgb>(64 * 32, {0.1f, 0.1f, 0.1f}), 0};
  for (uint32_t k = 0; k < 50; ++k)  // from bright to a thousand times as bright
    map.radiance[(k * 37) % map.radiance.size()] = Rgb{1, 1, 1} * std::pow(1.15f, float(k)) * 10.0f;
  const Surroundings s = surroundings_of(scene);
  ASSERT_GT(s.bright_texels.size(), 20u);
  constexpr int kSteps = 100000;
  std::vector<double> met(map.radiance.size());
  for (int k = 0; k < kSteps; ++k) {
    const BrightTexelSample p = sample_bright_texels(scene, s, {(float(k) + 0.5f) / kSteps, 0.5f});
    met[scene::pixel_towards(map, p.direction)] += 1.0 / kSteps;
  }
  for (size_t k = 0; k < s.bright_texels.size(); ++k) {
    const double share = (s.below[k + 1] - s.below[k]) / s.below.back();
    // At both ends of its part a step may be missed or taken; and at its pixel's border, by
    // rounding.
    EXPECT_NEAR(met[s.bright_texels[k]], share, 3.0 / kSteps) << k;
  }
}

TEST(Surroundings, ManyAtOnceAreThoseOneByOne) {
  const scene::Scene scene = sky_with_sun();
  const Surroundings s = surroundings_of(scene);
  std::vector<Vec3> directions;
  for (uint32_t k = 0; k < 1000; ++k)
    directions.push_back(uniform_sphere_sample(sobol_owen_2d(k, 9)));
  std::vector<Rgb> found{{9, 9, 9}};  // of before
  soft_radiance(scene, s, directions, found);
  ASSERT_EQ(found.size(), directions.size());
  for (size_t k = 0; k < found.size(); ++k)
    EXPECT_EQ(found[k], soft_radiance(scene, s, directions[k]));
  scene::Scene plain;
  plain.background = {1, 2, 3};
  soft_radiance(plain, surroundings_of(plain), std::span(directions).first(3), found);
  EXPECT_EQ(found, std::vector<Rgb>(3, {1, 2, 3}));
}

}  // namespace
}  // namespace luxel::light
