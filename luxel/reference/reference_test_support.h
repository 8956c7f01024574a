// Shared by the tests of the path tracer: points without an atlas, and the comparison with known
// light.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "luxel/base/vec_double.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/surface_points.h"
#include "luxel/viewfactor/rectangle_factor.h"

namespace luxel::reference::testing {

constexpr Rgb gray(float v) { return {v, v, v}; }

/// Places of surfaces of about a metre, where rays start.
struct Points {
  std::vector<Vec3> position, normal;
  void add(Vec3 p, Vec3 n) { position.push_back(scene::off_surface(p, n, 1)), normal.push_back(n); }
  size_t size() const { return position.size(); }
};

inline TexelPaths solve(const scene::Scene& scene, const Points& points, const PathParams& params) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  Progress progress;
  auto result = irradiance_by_paths(scene, {points.position, points.normal, points.normal}, *tracer,
                                    params, progress);
  EXPECT_TRUE(result);
  return std::move(*result);
}

/// `count` points on the front of the chosen triangles, uniform in area.
inline Points random_points(const scene::Scene& scene, size_t count, uint64_t seed) {
  Points points;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(scene, count, seed))
    points.add(scene::world_position(scene, p), scene::front_normal(scene, p.instance, p.triangle));
  return points;
}

/// No point is off by more than 5 of its own standard errors, and all together by no more than 3 of
/// theirs. `slack` is what is known not to be exact in the expectation, relative to it.
inline void expect_unbiased(const TexelPaths& result, const std::vector<double>& exact,
                            double slack = 0) {
  ASSERT_EQ(result.irradiance.size(), exact.size());
  double difference = 0, variance = 0, total = 0;
  for (size_t i = 0; i < exact.size(); ++i) {
    const double d = double(result.irradiance[i].x) - exact[i];
    const double se = double(result.standard_error[i].x);
    EXPECT_LE(std::abs(d), 5 * se + (slack + 2e-6) * exact[i])
        << "point " << i << ": " << result.irradiance[i].x << " instead of " << exact[i] << " +- "
        << se;
    difference += d, variance += se * se, total += exact[i];
  }
  EXPECT_LE(std::abs(difference), 3 * std::sqrt(variance) + (slack + 2e-6) * total)
      << "relative " << difference / total << " with a standard error of "
      << std::sqrt(variance) / total;
}

/// Lambert's formula for a polygon that lies wholly above the horizon, its corners
/// counter-clockwise seen from the point: F = 1/(2 pi) sum gamma_k n . (r_k x r_k+1) / |r_k x
/// r_k+1|.
inline double polygon_factor(Vec3 point, Vec3 normal, const std::vector<Vec3>& corners) {
  double sum = 0;
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vec3 a = corners[k] - point, b = corners[(k + 1) % corners.size()] - point;
    const Vec3 c = cross(a, b);
    const double sine = double(length(c));
    if (sine > 0) sum += std::atan2(sine, double(dot(a, b))) * double(dot(normal, c)) / sine;
  }
  return sum / (2 * kPiDouble);
}

using viewfactor::rectangle_factor;

}  // namespace luxel::reference::testing
