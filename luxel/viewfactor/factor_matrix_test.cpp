#include "luxel/viewfactor/factor_matrix.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/viewfactor/polygon_test_support.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/smooth_factors.h"

namespace luxel::viewfactor {
namespace {

scene::Scene room_of(const std::vector<Polygon>& faces) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  for (size_t f = 0; f < faces.size(); ++f) {
    scene::Mesh mesh;
    mesh.name = "face " + std::to_string(f);
    for (size_t i = 2; i < faces[f].size(); ++i)
      scene::add_triangle(mesh, to_float(faces[f][0]), to_float(faces[f][i - 1]),
                          to_float(faces[f][i]), 0);
    scene::place(scene, std::move(mesh));
  }
  return scene;
}

FactorMatrix analytic(const scene::Scene& scene) {
  Progress progress;
  return *analytic_factors(*surfaces_of(scene, progress), {}, {}, progress);
}

FactorMatrix by_rays(const scene::Scene& scene, uint32_t samples, int hemicube = 0) {
  Progress progress;
  const auto tracer = trace::RayTracer::build(scene);
  return *sampled_factors(scene, *surfaces_of(scene, progress), *tracer,
                          {.samples = samples, .hemicube = hemicube}, {}, progress);
}

TEST(FactorMatrix, ConvexRoomsAreClosed) {
  Dice dice;
  for (int i = 0; i < 10; ++i) {
    const FactorMatrix matrix = analytic(room_of(dice.convex_room(3 + i)));
    const FactorChecks checks = check_factors(matrix);
    // Corners are floats, 6e-8 of a side: rooms close to that over the size of their smallest face.
    EXPECT_LT(checks.largest_row_error, 2e-5);
    // One exchange area serves both directions: two divisions and two products are rounded.
    EXPECT_LT(checks.reciprocity_error, 1e-15);
  }
}

TEST(FactorMatrix, TheFurnaceBoxSeesItselfWhole) {
  for (const int tessellation : {1, 4}) {
    const FactorMatrix matrix =
        analytic(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}, tessellation));
    ASSERT_EQ(matrix.size(), 1u);
    EXPECT_NEAR(matrix.at(0, 0), 1, 1e-7);  // its corners, thirds and such, are floats
  }
}

// A box in a box: what the inner one radiates arrives at the outer one, which sees the rest of
// itself past it: F_oi = A_i / A_o and F_oo = 1 - A_i / A_o.
TEST(FactorMatrix, ABoxInABoxHasTheFactorsOfItsAreas) {
  scene::Scene scene = scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  const Box3 bounds = scene::world_bounds(scene);
  const Vec3 c = bounds.centre();
  scene::Mesh box;
  box.name = "box";
  scene::add_box(box, c - Vec3{0.2f, 0.1f, 0.15f}, c + Vec3{0.1f, 0.2f, 0.1f}, 0);
  scene::place(scene, box);
  const FactorMatrix matrix = analytic(scene);
  ASSERT_EQ(matrix.size(), 2u);
  const double ratio = matrix.area_m2[1] / matrix.area_m2[0];
  const double tolerance = AnalyticParams{}.tolerance;  // what is asked for, past blockers
  EXPECT_NEAR(matrix.at(1, 0), 1, tolerance);
  EXPECT_EQ(matrix.at(1, 1), 0);  // no face of a box lies in front of another
  EXPECT_NEAR(matrix.at(0, 1), ratio, tolerance * ratio);
  EXPECT_NEAR(matrix.at(0, 0), 1 - ratio, tolerance);
}

TEST(FactorMatrix, HasTheSameBitsForAnyNumberOfThreads) {
  const scene::Scene scene = scene::cornell_box();
  std::vector<double> analytic_bits, ray_bits, cube_bits, cube_errors;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    Progress progress;
    const FactorMatrix matrix =
        *analytic_factors(*surfaces_of(scene, progress), {.tolerance = 1e-2}, {}, progress);
    const FactorMatrix rays = by_rays(scene, 4096);
    const FactorMatrix cubes = by_rays(scene, 150, 8);  // more points than are held at a time
    if (threads == 1) {
      analytic_bits = matrix.factor, ray_bits = rays.factor;
      cube_bits = cubes.factor, cube_errors = cubes.error;
    }
    EXPECT_EQ(matrix.factor, analytic_bits);
    EXPECT_EQ(rays.factor, ray_bits);
    EXPECT_EQ(cubes.factor, cube_bits);
    EXPECT_EQ(cubes.error, cube_errors);
  }
}

TEST(FactorMatrixSlow, TheCornellBoxIsTheSameByRays) {
  const scene::Scene scene = scene::cornell_box();
  const FactorMatrix exact = analytic(scene);
  const FactorMatrix rays = by_rays(scene, 1u << 16), cubes = by_rays(scene, 64, 64);
  // A ray meets a surface or not, and stratified rays scatter less than independent ones: 3 of
  // their standard errors, and 2e-5 for what the exact side may be off where F is next to nothing.
  // A hemicube sees F(point), in [0, 1] with the mean f: over a surface it scatters by less than a
  // coin, sqrt(f (1 - f)), and the mean of 64 places in strata by much less than an eighth of that.
  // 2e-4 is a pixel's share, for what is hardly seen.
  for (size_t i = 0; i < exact.size(); ++i)
    for (size_t j = 0; j < exact.size(); ++j) {
      const double f = exact.at(i, j);
      EXPECT_NEAR(rays.at(i, j), f, 3 * std::sqrt(f * (1 - f) / 65536) + 2e-5)
          << exact.names[i] << " -> " << exact.names[j];
      EXPECT_NEAR(cubes.at(i, j), f, std::sqrt(f * (1 - f) / 64) + 2e-4)
          << exact.names[i] << " -> " << exact.names[j];
    }
}

// Sixteen pieces cannot follow the shadow of a turned plate between two squares.
TEST(FactorMatrix, WorkThatEndsEarlyIsSaid) {
  const Polygon floor{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Polygon ceiling{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}};
  const Polygon plate{{0.5, 0.2, 0.5}, {0.8, 0.5, 0.4}, {0.5, 0.8, 0.5}, {0.2, 0.5, 0.6}};
  const scene::Scene scene = room_of({floor, ceiling, plate});
  Progress progress;
  const Surfaces surfaces = *surfaces_of(scene, progress);
  const FactorMatrix fine = *analytic_factors(surfaces, {}, {}, progress);
  EXPECT_TRUE(fine.warnings.empty());
  const FactorMatrix rough = *analytic_factors(surfaces, {.max_cells = 16}, {}, progress);
  ASSERT_EQ(rough.warnings.size(), 1u);
  EXPECT_NE(rough.warnings[0].find("'face 0' and 'face 1'"), std::string::npos)
      << rough.warnings[0];
  EXPECT_GT(rough.error[1], 1e-4 * rough.at(0, 1));
  EXPECT_NE(rough.warnings[0].find(fmt::format("{:.1e}", rough.error[1])), std::string::npos);
  EXPECT_NEAR(rough.at(0, 1), fine.at(0, 1), rough.error[1]);
}

TEST(FactorMatrix, OneRowOrOneEntryIsThatOfTheWhole) {
  const scene::Scene scene = scene::cornell_box(scene::CornellColors::pbrt, false);
  Progress progress;
  const Surfaces surfaces = *surfaces_of(scene, progress);
  const FactorMatrix whole = *analytic_factors(surfaces, {}, {}, progress);
  const FactorMatrix row = *analytic_factors(surfaces, {}, {.from = 1}, progress);
  const FactorMatrix entry = *analytic_factors(surfaces, {}, {.from = 1, .to = 3}, progress);
  for (size_t j = 0; j < whole.size(); ++j) EXPECT_EQ(row.at(1, j), whole.at(1, j));
  EXPECT_EQ(entry.at(1, 3), whole.at(1, 3));
  EXPECT_GT(entry.at(1, 3), 0.01);
}

TEST(FactorMatrix, CancelledWorkIsAnError) {
  Progress progress;
  const Surfaces surfaces = *surfaces_of(scene::cornell_box(), progress);
  progress.request_cancel();
  const auto matrix = analytic_factors(surfaces, {}, {}, progress);
  ASSERT_FALSE(matrix.has_value());
  EXPECT_EQ(matrix.error().code, ErrorCode::cancelled);
}

// The factors of a few hundred points are their mean however they are taken in batches: a second
// half of the points alone would give others. The memory is that of one batch.
TEST(FactorMatrix, HemicubesInBatchesHaveTheErrorTheyClaim) {
  Dice dice;
  const scene::Scene scene = room_of(dice.convex_room(3));
  const FactorMatrix exact = analytic(scene);
  const FactorMatrix cubes = by_rays(scene, 300, 16);
  double worst = 0;
  for (size_t k = 0; k < exact.factor.size(); ++k)
    worst = std::max(worst, std::abs(cubes.factor[k] - exact.factor[k]) / cubes.error[k]);
  EXPECT_LT(worst, 4);
  const SampledParams few{.samples = 64, .hemicube = 64}, many{.samples = 1u << 24, .hemicube = 64};
  EXPECT_EQ(sampled_factor_bytes(20000, few), sampled_factor_bytes(20000, many));
  EXPECT_LT(sampled_factor_bytes(20000, many), 16u << 20);
}

FactorMatrix smoothed(FactorMatrix matrix) {
  Progress progress;
  EXPECT_TRUE(smooth_factors(matrix, progress).has_value());
  return matrix;
}

TEST(SmoothFactors, StopsWhenAsked) {
  Dice dice;
  FactorMatrix matrix = analytic(room_of(dice.convex_room(6)));
  Progress progress;
  progress.request_cancel();
  const auto change = smooth_factors(matrix, progress);
  ASSERT_FALSE(change.has_value());
  EXPECT_EQ(change.error().code, ErrorCode::cancelled);
}

TEST(SmoothFactors, RestoresBothLawsAndComesCloserToTheTruth) {
  Dice dice;
  const scene::Scene scene = room_of(dice.convex_room(6));
  const FactorMatrix exact = analytic(scene);
  FactorMatrix matrix = by_rays(scene, 4096);
  // Rays of a closed room keep the sums; spoil them as a coarse method would.
  for (double& f : matrix.factor) f *= 1 + 0.02 * dice.number();
  const FactorMatrix before = matrix;
  matrix = smoothed(matrix);
  const FactorChecks checks = check_factors(matrix);
  // Sums of a dozen factors, to their last bits; the loop ends where they no longer change.
  EXPECT_LT(checks.largest_row_error, 1e-12);
  EXPECT_LT(checks.reciprocity_error, 1e-12);
  double error_before = 0, error_after = 0;
  for (size_t k = 0; k < matrix.factor.size(); ++k) {
    EXPECT_GE(matrix.factor[k], 0);
    error_before += std::pow(before.factor[k] - exact.factor[k], 2);
    error_after += std::pow(matrix.factor[k] - exact.factor[k], 2);
  }
  // A projection onto the laws leaves the error within them. Of 6 x 6 entries the laws fix 21; the
  // smallest part of the spoiled numbers that they could undo is not known, 5 % is sure.
  EXPECT_LT(error_after, 0.95 * error_before);
}

TEST(SmoothFactors, LeavesAConsistentMatrixAlone) {
  Dice dice;
  FactorMatrix matrix = analytic(room_of(dice.convex_room(6)));
  matrix = smoothed(matrix);
  const FactorMatrix once = matrix;
  Progress progress;
  const auto change = smooth_factors(matrix, progress);
  ASSERT_TRUE(change.has_value());
  EXPECT_LT(*change, 1e-13);  // the last bits of sums of a dozen factors
}

TEST(SmoothFactors, RefusesOpenScenes) {
  FactorMatrix matrix = analytic(scene::cornell_box(scene::CornellColors::pbrt, false));
  Progress progress;
  const auto change = smooth_factors(matrix, progress);
  ASSERT_FALSE(change.has_value());
  EXPECT_NE(change.error().message.find("'"), std::string::npos) << change.error().message;
}

}  // namespace
}  // namespace luxel::viewfactor
