// The exact solutions of closed rooms: shared/reference/exact-solutions.md, sections 1 to 6 and 9.
#include "reference/path_tracer.h"

#include <gtest/gtest.h>

#include <numeric>

#include "reference/reference_test_support.h"
#include "scene/procedural.h"
#include "tests/reference_data.h"

namespace luxel::reference {
namespace {

namespace shared = luxel::testing_support;
using namespace testing;

constexpr Rgb gray(float v) { return {v, v, v}; }
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

// Section 2: a lamp of 10 000 lm in a room of 4 x 4 x 4 m; mean indirect illuminance is
// Phi rho / (A (1 - rho)), whatever the place of the lamp and of what stands in the room.
TEST(SlowEnclosures, TheMeanLawHoldsInARoomWithALamp) {
  LUXEL_NEEDS_SHARED("reference/exact-solutions.md");
  const auto rows = shared::markdown_rows("reference/exact-solutions.md", "Mean law", "rho");
  ASSERT_EQ(rows.size(), 1u);
  const std::vector<float> reflectances{0.05f, 0.1f, 0.3f, 0.5f, 0.7f, 0.9f, 0.95f};
  for (size_t k = 0; k < reflectances.size(); ++k) {
    const float rho = reflectances[k];
    scene::Scene scene = scene::furnace_box(gray(rho), {});
    scene.instances[0].world_from_object = scaling({4, 4, 4});
    const Box3 room = scene::world_bounds(scene);
    scene::PunctualLight lamp;
    lamp.position = room.lower + Vec3{1, 3, 1.5f};
    lamp.intensity = gray(10000 / (4 * kPi));
    scene.lights.push_back(lamp);
    const Points points = random_points(scene, 50000, 3);
    const Mean all = mean_over_random_points(solve(scene, points, {.samples = 4}));
    const double direct = 10000.0 / 96;
    EXPECT_NEAR(all.value - direct, std::stod(rows[0][k + 1]), 3 * all.error) << "rho " << rho;
    EXPECT_LT(all.error, 0.01 * all.value);
  }
}

// Section 2 with emission on some walls, and a reflecting block in the room.
TEST(SlowEnclosures, TheMeanLawHoldsForAnyEmissionAndBlockers) {
  scene::Scene scene = scene::furnace_box(gray(0.7f), {});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emission = {2, 0, 0};
  for (size_t t = 0; t < 3; ++t) scene.meshes[0].triangle_material[t] = 1;
  scene::Mesh block;
  const Vec3 centre = scene::world_bounds(scene).centre();
  scene::add_box(block, centre - Vec3{0.2f, 0.1f, 0.3f}, centre + Vec3{0.1f, 0.3f, 0.2f}, 0);
  scene::place(scene, std::move(block));
  double area = 0, power = 0;
  for (uint32_t i = 0; i < 2; ++i)
    for (uint32_t t = 0; t < scene.meshes[i].triangles.size(); ++t) {
      const double a = double(scene::area_m2(scene::world_triangle(scene, i, t)));
      area += a;
      power += a * kPiDouble * double(scene::emission_at(scene, {i, t, {}}).x);
    }
  const Points points = random_points(scene, 100000, 4);
  const Mean mean = mean_over_random_points(solve(scene, points, {.samples = 4}));
  EXPECT_NEAR(mean.value, power / area / 0.3, 3 * mean.error);
  EXPECT_LT(mean.error, 0.004 * mean.value);
}

/// A sphere of 20,480 facets (1 degree across): what their edges change is below 5e-4 here.
constexpr int kFineLevels = 5;
constexpr double kFacets = 5e-4;

/// Gives the facets of a sphere materials from the top downwards, by shares of the area; returns
/// the shares that whole facets make.
std::vector<double> paint_zones(scene::Scene& scene, const std::vector<double>& shares) {
  scene::Mesh& mesh = scene.meshes[0];
  std::vector<uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto height = [&](uint32_t t) {
    const scene::Triangle3 w = scene::world_triangle(scene, 0, t);
    return w.a.y + w.b.y + w.c.y;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return height(a) > height(b); });
  double total = 0, done = 0, limit = shares[0];
  for (const uint32_t t : order)
    total += double(scene::area_m2(scene::world_triangle(scene, 0, t)));
  std::vector<double> painted(shares.size());
  uint32_t zone = 0;
  for (const uint32_t t : order) {
    if (done >= limit * total && zone + 1 < shares.size()) limit += shares[++zone];
    const double a = double(scene::area_m2(scene::world_triangle(scene, 0, t)));
    mesh.triangle_material[t] = zone;
    painted[zone] += a / total, done += a;
  }
  return painted;
}

// Section 3: B = e + rho H, H = mean(e) / (1 - mean(rho)): the reflected light arrives evenly, and
// so does the emitted: E = mean(e) + mean(rho) H = H everywhere.
TEST(SlowEnclosures, ASphereWithZonesSharesItsLightEvenly) {
  const std::vector<double> shares{0.2, 0.3, 0.5}, rho{0.8, 0.5, 0.2};
  scene::Scene scene = scene::inward_sphere(1, kFineLevels, gray(0.8f), exitance(1));
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].base_color = gray(0.5f), scene.materials[1].emission = {};
  scene.materials.push_back(scene.materials[1]);
  scene.materials[2].base_color = gray(0.2f);
  const std::vector<double> area = paint_zones(scene, shares);
  const double h = area[0] / (1 - (area[0] * rho[0] + area[1] * rho[1] + area[2] * rho[2]));
  for (const uint32_t zone : {0u, 1u, 2u}) {
    const Points points = random_points(scene, 2000, 5 + zone, of_material(zone));
    expect_unbiased(solve(scene, points, {.samples = 100}), std::vector<double>(2000, h), kFacets);
    const double b = (zone == 0 ? 1 : 0) + rho[zone] * h;
    // The zones are those of the reference within a facet.
    EXPECT_NEAR(b, zone == 0 ? 1.271186 : zone == 1 ? 0.169492 : 0.067797, 2e-4);
  }
}

// Section 3: the integrating sphere. A beam strikes the wall; E away from it is
// Phi rho / (4 pi R^2 (1 - rho (1 - f))), with a black port of area share f.
TEST(SlowEnclosures, AnIntegratingSphereGivesItsIlluminance) {
  const float radius = 2, rho = 0.9f;
  scene::Scene scene = scene::inward_sphere(radius, kFineLevels, gray(rho), {});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].base_color = {};
  // Material 0 is the wall, so that the last 5 % are the port.
  const double f = paint_zones(scene, {0.95, 0.05})[1];
  scene::PunctualLight beam;
  beam.kind = scene::PunctualLight::Kind::spot;
  beam.direction = {1, 0, 0};
  beam.outer_cone_rad = 0.3f, beam.inner_cone_rad = 0.1f;
  // A squared ramp in the cosine between the cones: Phi = 2 pi I (1 - ci + (ci - co) / 3).
  const double co = std::cos(0.3), ci = std::cos(0.1);
  beam.intensity = gray(float(1000 / (2 * kPiDouble * (1 - ci + (ci - co) / 3))));
  scene.lights.push_back(beam);
  const Points points = random_points(scene, 400, 8, [&](const auto& s, const auto& p) {
    return scene::world_position(s, p).x < 0;
  });
  double area = 0;
  for (uint32_t t = 0; t < scene.meshes[0].triangles.size(); ++t)
    area += double(scene::area_m2(scene::world_triangle(scene, 0, t)));
  const double expected = 1000 * double(rho) / (area * (1 - double(rho) * (1 - f)));
  // 123.48 lx on the sphere itself; the facets have 3e-4 less area.
  EXPECT_NEAR(expected, 123.482283, 0.1);
  // The beam's spot is small and bright: single points need many paths until their mean is normal.
  expect_unbiased(solve(scene, points, {.samples = 1000}), std::vector<double>(400, expected),
                  2 * kFacets);
}

// Section 4: two plates a thousand times as wide as their distance, seen from the middle: what they
// miss is 4e-6.
TEST(Enclosures, ParallelPlatesExchangeLight) {
  scene::Scene scene;
  scene::add_material(scene, "lower", gray(0.5f), exitance(1));
  scene::add_material(scene, "upper", gray(0.8f), exitance(0.25f));
  scene::add_rectangle(scene, {-500, 500, -500, 500}, 0, true, 0);
  scene::add_rectangle(scene, {-500, 500, -500, 500}, 1, false, 1);
  Points points;
  std::vector<double> exact;
  const double b1 = (1 + 0.5 * 0.25) / (1 - 0.4), b2 = (0.25 + 0.8 * 1) / (1 - 0.4);
  for (int k = 0; k < 50; ++k) {
    points.add({float(k) * 0.3f, 0, 1}, {0, 1, 0}), exact.push_back(b2);
    points.add({float(k) * 0.3f, 1, 1}, {0, -1, 0}), exact.push_back(b1);
  }
  expect_unbiased(solve(scene, points, {.samples = 4000}), exact, 1e-5);
}

// Section 5: concentric spheres of radius 1 (seen from outside) and 2 (from inside).
TEST(SlowEnclosures, ConcentricSpheresExchangeLight) {
  for (const bool inner_shines : {true, false}) {
    const double e1 = inner_shines, e2 = !inner_shines, rho1 = 0.3, rho2 = 0.7, q = 0.25;
    const double d = 1 - rho2 * (1 - q) - rho1 * rho2 * q;
    const double b1 = (e1 * (1 - rho2 * (1 - q)) + rho1 * e2) / d, b2 = (e2 + rho2 * q * e1) / d;
    scene::Scene scene =
        scene::inward_sphere(2, kFineLevels, gray(float(rho2)), exitance(float(e2)));
    scene::Scene inner =
        scene::inward_sphere(1, kFineLevels, gray(float(rho1)), exitance(float(e1)));
    for (auto& t : inner.meshes[0].triangles) std::swap(t[1], t[2]);
    inner.meshes[0].triangle_material.assign(inner.meshes[0].triangles.size(), 1);
    scene.materials.push_back(inner.materials[0]);
    scene::place(scene, inner.meshes[0]);
    const Points on_inner = random_points(scene, 2000, 9, of_material(1));
    const Points on_outer = random_points(scene, 2000, 10, of_material(0));
    // B = e + rho E.
    expect_unbiased(solve(scene, on_inner, {.samples = 100}),
                    std::vector<double>(2000, (b1 - e1) / rho1), 2 * kFacets);
    expect_unbiased(solve(scene, on_outer, {.samples = 100}),
                    std::vector<double>(2000, (b2 - e2) / rho2), 2 * kFacets);
  }
}

/// The limit of a geometric sequence from three of its members (Aitken).
double limit_of(double a, double b, double c) { return c - (c - b) * (c - b) / (c - 2 * b + a); }

// Section 6: a cube with rho = 0.5 and one wall of e = 1. Face means of the continuous solution, to
// which the table's Galerkin solutions converge.
TEST(SlowEnclosures, TheFacesOfACubeReachTheContinuousLimit) {
  LUXEL_NEEDS_SHARED("reference/exact-solutions.md");
  const auto rows = shared::markdown_rows("reference/exact-solutions.md", "6 Cube", "n");
  ASSERT_GE(rows.size(), 5u);
  std::array<double, 3> limit{};
  for (size_t k = 0; k < 3; ++k)
    limit[k] =
        limit_of(std::stod(rows[2][k + 1]), std::stod(rows[3][k + 1]), std::stod(rows[4][k + 1]));
  EXPECT_NEAR(limit[0], 1.1044, 1e-4);
  scene::Scene scene = scene::furnace_box(gray(0.5f), {});
  scene::add_material(scene, "lamp", gray(0.5f), exitance(1));
  const Box3 box = scene::world_bounds(scene);
  const auto face = [&](float y) {
    return [&scene, y](const scene::Scene& s, const scene::SurfacePoint& p) {
      const scene::Triangle3 t = scene::world_triangle(s, p.instance, p.triangle);
      return t.a.y == y && t.b.y == y && t.c.y == y;
    };
  };
  const Chosen floor = face(box.lower.y), ceiling = face(box.upper.y);
  for (uint32_t t = 0; t < scene.meshes[0].triangles.size(); ++t)
    if (floor(scene, {0, t, {}})) scene.meshes[0].triangle_material[t] = 1;
  const Chosen side = [&](const scene::Scene& s, const scene::SurfacePoint& p) {
    return !floor(s, p) && !ceiling(s, p);
  };
  const std::array<Chosen, 3> faces{floor, ceiling, side};
  for (size_t k = 0; k < 3; ++k) {
    const Points points = random_points(scene, 150000, 11 + k, faces[k]);
    const Mean e = mean_over_random_points(solve(scene, points, {.samples = 4}));
    EXPECT_NEAR((k == 0 ? 1 : 0) + 0.5 * e.value, limit[k], 3 * 0.5 * e.error + 5e-5);
    EXPECT_LT(0.5 * e.error, 5e-4);
  }
}

// Section 9: two unit squares with emission e = 1 - rho F, F the factor to the whole other square,
// have B = 1 everywhere, so E = F. Emission is constant on each of 24 x 24 cells at its mean: what
// that changes at distance 1 is below 1e-5.
TEST(Enclosures, AManufacturedSolutionIsReproduced) {
  constexpr int kCells = 24;
  const auto factor = [](double x, double z) { return rectangle_factor(-x, 1 - x, -z, 1 - z, 1); };
  scene::Scene scene;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      double mean = 0;
      for (int k = 0; k < 64; ++k)
        mean += factor((i + (k % 8 + 0.5) / 8) / kCells, (j + (k / 8 + 0.5) / 8) / kCells) / 64;
      const uint32_t material =
          scene::add_material(scene, "cell", gray(0.5f), exitance(float(1 - 0.5 * mean)));
      const float h = 1.0f / kCells, x = float(i) * h, z = float(j) * h;
      scene::add_rectangle(scene, {x, x + h, z, z + h}, 0, true, material);
      scene::add_rectangle(scene, {x, x + h, z, z + h}, 1, false, material);
    }
  Points points;
  std::vector<double> exact;
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i) {
      const float x = (float(i) + 0.25f) / 10, z = (float(j) + 0.75f) / 10;
      points.add({x, i % 2 ? 0.0f : 1.0f, z}, {0, i % 2 ? 1.0f : -1.0f, 0});
      exact.push_back(factor(double(x), double(z)));
    }
  expect_unbiased(solve(scene, points, {.samples = 4000}), exact, 2e-5);
}

}  // namespace
}  // namespace luxel::reference
