// What the tests of the path tracer share: points without an atlas, and the comparison with what is
// known.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/random.h"
#include "base/vec_double.h"
#include "base/warp.h"
#include "reference/path_tracer.h"
#include "scene/shapes.h"

namespace luxel::reference::testing {

struct Points {
  std::vector<Vec3> position, normal;
  void add(Vec3 p, Vec3 n) { position.push_back(p), normal.push_back(n); }
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

using Chosen = std::function<bool(const scene::Scene&, const scene::SurfacePoint&)>;
inline bool everywhere(const scene::Scene&, const scene::SurfacePoint&) { return true; }

/// `count` points on the front of the chosen triangles, uniform in area.
inline Points random_points(const scene::Scene& scene, size_t count, uint64_t seed,
                            const Chosen& chosen = everywhere) {
  std::vector<scene::SurfacePoint> triangles;
  std::vector<double> area_below{0};
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      if (!chosen(scene, {i, t, {}})) continue;
      triangles.push_back({i, t, {}});
      area_below.push_back(area_below.back() +
                           double(scene::area_m2(scene::world_triangle(scene, i, t))));
    }
  Points points;
  RandomStream random{hash64(seed)};
  for (size_t k = 0; k < count; ++k) {
    const double area = double(random.next()) * area_below.back();
    const auto found = std::upper_bound(area_below.begin() + 1, area_below.end() - 1, area);
    scene::SurfacePoint p = triangles[size_t(found - area_below.begin()) - 1];
    p.at = triangle_sample(random.next2());
    points.add(scene::world_position(scene, p), scene::front_normal(scene, p.instance, p.triangle));
  }
  return points;
}

inline Chosen of_material(uint32_t material) {
  return [material](const scene::Scene& scene, const scene::SurfacePoint& p) {
    return scene.meshes[scene.instances[p.instance].mesh].triangle_material[p.triangle] == material;
  };
}

/// The mean of the red channel over all points and its standard error, which counts the scatter
/// from point to point too when points were drawn by chance.
struct Mean {
  double value = 0, error = 0;
};
inline Mean mean_over_random_points(const TexelPaths& result) {
  double sum = 0, sum2 = 0;
  const double n = double(result.irradiance.size());
  for (const Rgb& e : result.irradiance) sum += double(e.x), sum2 += double(e.x) * double(e.x);
  return {sum / n, std::sqrt(std::max(0.0, sum2 / n - sum / n * sum / n) / (n - 1))};
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

/// The same for the rectangle [x0, x1] x [z0, z1] in the plane y = height above a point at the
/// origin that looks up (Howell B-3, four corners).
inline double rectangle_factor(double x0, double x1, double z0, double z1, double height) {
  const auto corner = [&](double x, double z) {
    const double a = x / height, b = z / height;
    const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * kPiDouble);
  };
  return corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0);
}

}  // namespace luxel::reference::testing
