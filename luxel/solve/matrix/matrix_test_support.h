// Helpers for tests of the matrix solver: small scenes, their patches and their factors.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/matrix/form_factors.h"
#include "luxel/solve/matrix/hierarchical.h"
#include "luxel/solve/matrix/patches.h"

namespace luxel::matrix::testing {

/// The square [0, 1]^2 at y = 0, front upwards.
inline scene::Scene plate() {
  scene::Scene scene;
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true,
                       scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}));
  return scene;
}

inline constexpr float kWallHalf_m = 0.005f;

/// The floor [-1, 1] x [0, 1] and, standing on it at x = 0, a wall of one centimetre, 0.5 m high.
inline scene::Scene floor_with_wall() {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-1, 1, 0, 1}, 0, true, gray);
  scene::add_rectangle(scene, {-kWallHalf_m, kWallHalf_m, 0, 1}, 0.5f, true, gray);
  scene::Mesh wall;
  const float a = -kWallHalf_m, b = kWallHalf_m, h = 0.5f;
  scene::add_quad(wall, {Vec3{a, 0, 0}, {a, 0, 1}, {a, h, 1}, {a, h, 0}}, gray);
  scene::add_quad(wall, {Vec3{b, 0, 1}, {b, 0, 0}, {b, h, 0}, {b, h, 1}}, gray);
  scene::place(scene, std::move(wall));
  return scene;
}

inline double area_of(const scene::Scene& scene) {
  double area = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      area += double(scene::area_m2(scene::world_triangle(scene, i, t)));
  return area;
}

inline double sum_of(std::span<const float> v) {
  double sum = 0;
  for (const float x : v) sum += double(x);
  return sum;
}

/// A scene in patches.
struct Cut {
  scene::Scene scene;
  trace::RayTracer tracer;
  PatchedScene patched;

  Cut(scene::Scene s, size_t count, int points = 48, uint64_t seed = 1)
      : scene(std::move(s)), tracer(*trace::RayTracer::build(scene)) {
    Progress progress;
    auto made = make_patches(scene, tracer, {count, points, seed}, progress);
    EXPECT_TRUE(made) << made.error().message;
    if (made) patched = std::move(*made);
  }
  const Patches& patches() const { return patched.patches; }
  size_t size() const { return patched.patches.size(); }

  TracedFactors traced(int rays) const {
    Progress progress;
    auto out = trace_factors(scene, tracer, patched, {rays, 1}, progress);
    EXPECT_TRUE(out);
    return out ? std::move(*out) : TracedFactors{};
  }
  FormFactors reciprocal_factors(int rays) const {
    return reciprocal(traced(rays).factors, patched.patches.area_m2);
  }
};

/// Numbers in [0, 1) per channel.
inline std::vector<Rgb> random_light(size_t count, uint64_t seed) {
  RandomStream random{seed};
  std::vector<Rgb> out(count);
  for (Rgb& c : out) c = {random.next(), random.next(), random.next()};
  return out;
}

/// The product by its definition.
inline void plain_product(const FormFactors& f, std::span<const Rgb> radiosity,
                          std::span<Rgb> irradiance) {
  for (size_t i = 0; i < f.size(); ++i) {
    std::array<double, 3> sum{};
    const auto columns = f.columns_of(i);
    for (size_t k = 0; k < columns.size(); ++k)
      for (int c = 0; c < 3; ++c)
        sum[size_t(c)] += double(f.factors_of(i)[k]) * double(radiosity[columns[k]][c]);
    irradiance[i] = {float(sum[0]), float(sum[1]), float(sum[2])};
  }
}
inline std::vector<Rgb> plain_product(const FormFactors& f, std::span<const Rgb> radiosity) {
  std::vector<Rgb> out(f.size());
  plain_product(f, radiosity, out);
  return out;
}

/// The matrix of the inside of a sphere in patches: F_ij = A_j / A, wherever i lies.
inline FormFactors sphere_factors(std::span<const float> area_m2) {
  const double whole = sum_of(area_m2);
  FormFactors f;
  f.first.push_back(0);
  for (size_t i = 0; i < area_m2.size(); ++i) {
    for (uint32_t j = 0; j < area_m2.size(); ++j) {
      f.column.push_back(j);
      f.factor.push_back(float(double(area_m2[j]) / whole));
    }
    f.first.push_back(f.column.size());
  }
  return f;
}

/// Root of the mean square difference, weighted by area, over that of `b`.
inline double relative_error(std::span<const Rgb> a, std::span<const Rgb> b,
                             std::span<const float> area_m2) {
  double error = 0, size = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const Vec3 d = a[i] - b[i];
    error += double(area_m2[i] * dot(d, d)), size += double(area_m2[i] * dot(b[i], b[i]));
  }
  return std::sqrt(error / size);
}

}  // namespace luxel::matrix::testing
