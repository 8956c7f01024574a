// Direct light of hundreds of lights, against sums of what each one brings.
#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/vec_double.h"
#include "luxel/light/direct_light.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"

namespace luxel::light {
namespace {

constexpr int kSide = 20;

/// The factor from a point to a rectangle that faces it at height h, corners (0, 0) and (x, y)
/// above the point [Siegel, configuration 10]; odd in x and in y.
double corner_factor(double x, double y, double h) {
  const double a = std::hypot(x, h), b = std::hypot(y, h);
  return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * kPiDouble);
}
double facing_factor(double x0, double x1, double y0, double y1, double h) {
  return corner_factor(x1, y1, h) - corner_factor(x0, y1, h) - corner_factor(x1, y0, h) +
         corner_factor(x0, y0, h);
}

/// A grid of square lamps of 0.2 m and L = 1, 2, 3, 1, 2 ... at a height of 3 m, that look down.
struct Squares {
  scene::Scene scene;
  struct Lamp {
    float x, z, radiance;
  };
  std::vector<Lamp> lamps;
};
Squares squares() {
  Squares out;
  for (int k = 0; k < kSide * kSide; ++k) {
    const float l = float(1 + k % 3);
    const Squares::Lamp lamp{float(k % kSide), float(k / kSide), l};
    const uint32_t material = scene::add_material(out.scene, "lamp", {}, Rgb{l, l, l});
    scene::add_rectangle(out.scene, {lamp.x - 0.1f, lamp.x + 0.1f, lamp.z - 0.1f, lamp.z + 0.1f}, 3,
                         false, material);
    out.lamps.push_back(lamp);
  }
  return out;
}

/// One point many times: every element has a seed of its own.
transport::Elements copies(Vec3 position, Vec3 normal, size_t count) {
  transport::Elements e;
  e.position.assign(count, scene::off_surface(position, normal, 1));
  e.normal.assign(count, normal), e.geometric_normal.assign(count, normal);
  e.reflectance.assign(count, {0.5f, 0.5f, 0.5f});
  return e;
}

struct Sample {
  double mean = 0, standard_error = 0;  ///< of the mean
  double variance = 0, estimated_variance = 0;
};
Sample sample(const scene::Scene& scene, Vec3 position, int samples) {
  constexpr size_t kCopies = 4096;
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  const auto light = direct_light(scene, copies(position, {0, 1, 0}, kCopies),
                                  collect_lights(scene), *tracer, {samples, 1}, progress);
  EXPECT_TRUE(light);
  Sample out;
  double sum2 = 0;
  for (size_t i = 0; i < kCopies; ++i) {
    const double e = double(luminance(light->irradiance[i]));
    out.mean += e / kCopies, sum2 += e * e / kCopies;
    out.estimated_variance += double(light->variance[i]) / kCopies;
  }
  out.variance = std::max(0.0, sum2 - out.mean * out.mean);
  out.standard_error = std::sqrt(out.variance / kCopies);
  return out;
}

// 400 squares, 800 triangles, few rays: the mean is the sum of 400 closed forms. Points below the
// middle, below an edge lamp, and so near a lamp that it gets rays for certain.
TEST(DirectMany, FourHundredSquaresAreTheSumOfTheirFactors) {
  const Squares hall = squares();
  for (const Vec3 p : {Vec3{9.7f, 0, 10.2f}, Vec3{0, 1, 4.5f}, Vec3{5.05f, 2.8f, 7.02f}}) {
    double exact = 0;
    for (const Squares::Lamp& lamp : hall.lamps) {
      const double x = double(lamp.x - p.x), z = double(lamp.z - p.z);
      exact += kPiDouble * double(lamp.radiance) *
               facing_factor(x - 0.1, x + 0.1, z - 0.1, z + 0.1, 3 - double(p.y));
    }
    for (const int samples : {8, 32}) {
      const Sample s = sample(hall.scene, p, samples);
      // Four standard errors, and what floats round.
      EXPECT_NEAR(s.mean, exact, 4 * s.standard_error + 1e-4 * exact) << samples << " " << p.y;
      // Rays go where light comes from: 32 of them leave 5 % at most, 8 of them 15 %.
      EXPECT_LT(std::sqrt(s.variance), (samples == 8 ? 0.15 : 0.05) * exact) << p.y;
      // The estimate is that of differences between neighbours on the line: usually larger than
      // the truth; a grid of lamps may be in step with the rays and look calmer than it is.
      EXPECT_GT(s.estimated_variance, 0.4 * s.variance) << samples << " " << p.y;
      EXPECT_LT(s.estimated_variance, 10 * s.variance + 1e-6 * exact * exact) << p.y;
    }
  }
}

// A plate over half of them: those above it are gone, to the last one.
TEST(DirectMany, APlateHidesWhatIsAboveIt) {
  Squares hall = squares();
  const uint32_t gray = scene::add_material(hall.scene, "plate", {0.5f, 0.5f, 0.5f}, {});
  // From z = 9.5 at height 3 the line of sight from z = 9.5 runs straight up.
  scene::add_rectangle(hall.scene, {-200, 200, 9.5f, 200}, 0.5f, false, gray);
  const Vec3 p{9.7f, 0, 9.5f};
  double exact = 0;
  for (const Squares::Lamp& lamp : hall.lamps) {
    if (lamp.z > 9.5f) continue;
    const double x = double(lamp.x - p.x), z = double(lamp.z - p.z);
    exact +=
        kPiDouble * double(lamp.radiance) * facing_factor(x - 0.1, x + 0.1, z - 0.1, z + 0.1, 3);
  }
  const Sample s = sample(hall.scene, p, 32);
  EXPECT_NEAR(s.mean, exact, 4 * s.standard_error + 1e-4 * exact);
}

// 400 lamps without area, of which a few are spots or end at a range, and a sun: I cos / d^2 each.
TEST(DirectMany, FourHundredLampsAreTheSumOfTheirLight) {
  scene::Scene scene;
  scene::add_rectangle(scene, {-1, -0.9f, -1, -0.9f}, -5, true,
                       scene::add_material(scene, "far", {0.5f, 0.5f, 0.5f}, {}));
  for (int k = 0; k < kSide * kSide; ++k) {
    scene::PunctualLight lamp;
    lamp.position = {float(k % kSide), 2.0f + 0.1f * float(k % 7), float(k / kSide)};
    lamp.intensity = Rgb{1, 1, 1} * float(1 + k % 3);
    if (k % 5 == 0) lamp.kind = scene::PunctualLight::Kind::spot;
    if (k % 4 == 0) lamp.range_m = 6;
    scene.lights.push_back(lamp);
  }
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  scene.lights.push_back(sun);
  const Vec3 p{9.7f, 0, 10.2f};
  double exact = 1;
  for (int k = 0; k < kSide * kSide; ++k) {
    const scene::PunctualLight& lamp = scene.lights[size_t(k)];
    const Vec3 to = lamp.position - p;
    const double d = std::sqrt(double(dot(to, to))), cosine = double(to.y) / d;
    double e = double(lamp.intensity.x) * cosine / (d * d);
    if (k % 4 == 0) e *= std::max(0.0, 1 - std::pow(d / 6, 4));
    // The spots look straight down with cones of 0 and 45 degrees.
    const double outer = std::cos(kPiDouble / 4);
    if (k % 5 == 0) e *= std::pow(std::max(0.0, (cosine - outer) / (1 - outer)), 2);
    exact += e;
  }
  const Sample s = sample(scene, p, 1);
  EXPECT_NEAR(s.mean, exact, 4 * s.standard_error + 1e-4 * exact);
  EXPECT_LT(std::sqrt(s.variance), 0.05 * exact);
  EXPECT_GT(s.estimated_variance, 0.4 * s.variance);
}

}  // namespace
}  // namespace luxel::light
