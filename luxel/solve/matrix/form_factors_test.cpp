#include "luxel/solve/matrix/form_factors.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/matrix_test_support.h"
#include "luxel/viewfactor/polygon_form_factor.h"

namespace luxel::matrix {
namespace {

using testing::Cut;
using viewfactor::Polygon;

scene::Scene room() { return scene::furnace_box({0.5f, 0.5f, 0.5f}, {}); }

/// F_ij of the matrix; 0 where it holds none.
float entry(const FormFactors& f, size_t i, uint32_t j) {
  const auto columns = f.columns_of(i);
  const auto at = std::lower_bound(columns.begin(), columns.end(), j);
  return at != columns.end() && *at == j ? f.factors_of(i)[size_t(at - columns.begin())] : 0.0f;
}

void expect_ascending(const FormFactors& f) {
  for (size_t i = 0; i < f.size(); ++i) {
    const auto c = f.columns_of(i);
    EXPECT_TRUE(std::adjacent_find(c.begin(), c.end(), std::greater_equal<>()) == c.end());
  }
}

TEST(TraceFactors, RowsOfAClosedRoomSumToOne) {
  const Cut cut(room(), 300);
  const TracedFactors traced = cut.traced(500);
  EXPECT_EQ(traced.rays, 500 * cut.size());
  expect_ascending(traced.factors);
  for (size_t i = 0; i < cut.size(); ++i) {
    // Hundreds of floats below 1, each rounded to 3e-8 of itself: energy is kept.
    EXPECT_NEAR(row_sum(traced.factors, i), 1, 1e-6) << i;
    EXPECT_EQ(traced.sky[i], 0);
  }
}

TEST(TraceFactors, NothingButSkyOverAPlate) {
  const Cut cut(testing::plate(), 100);
  const TracedFactors traced = cut.traced(100);
  EXPECT_TRUE(traced.factors.column.empty());
  for (const float share : traced.sky) EXPECT_EQ(share, 1);
}

TEST(TraceFactors, NothingReachesABackUnlessItIsDoubleSided) {
  // A plate over another, its front upwards as well: the lower one sees its back.
  for (const bool double_sided : {false, true}) {
    scene::Scene scene = testing::plate();
    scene::add_rectangle(scene, {0, 1, 0, 1}, 1, true, 0);
    scene.materials[0].double_sided = double_sided;
    const Cut cut(scene, 100);
    double exchange = 0, sky = 0, area = 0;
    const TracedFactors traced = cut.traced(400);
    for (size_t i = 0; i < cut.size(); ++i) {
      if (cut.patches().centroid[i].y > 0.25f || cut.patches().elements.normal[i].y < 0) continue;
      const double a = double(cut.patches().area_m2[i]);
      area += a, exchange += a * row_sum(traced.factors, i), sky += a * double(traced.sky[i]);
    }
    const Polygon below{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}};
    const Polygon above{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}};
    const double f = viewfactor::polygon_form_factor(below, above);
    // The lower plate's upper side has at least 25 patches x 400 rays: a standard error of
    // sqrt(f (1 - f) / 10000) = 0.004.
    EXPECT_NEAR(exchange / area, double_sided ? f : 0, double_sided ? 4 * 0.004 : 0);
    EXPECT_NEAR(sky / area, 1 - f, 4 * 0.004);
  }
}

/// F from the patches of one rectangle to those of another, by the matrix: sum A_i F_ij / sum A_i.
double factor_between(const Cut& cut, const FormFactors& f, auto&& in_a, auto&& in_b) {
  double exchange = 0, area = 0;
  for (uint32_t i = 0; i < cut.size(); ++i) {
    if (!in_a(i)) continue;
    const double a = double(cut.patches().area_m2[i]);
    area += a;
    for (uint32_t j = 0; j < cut.size(); ++j)
      if (in_b(j)) exchange += a * double(entry(f, i, j));
  }
  return exchange / area;
}

TEST(TraceFactors, ParallelSquaresByTheClosedForm) {
  scene::Scene scene = testing::plate();
  scene::add_rectangle(scene, {0, 1, 0, 1}, 1, false, 0);
  const Cut cut(scene, 200);
  const FormFactors traced = cut.traced(1000).factors;
  const FormFactors both = reciprocal(traced, cut.patches().area_m2);
  const auto below = [&](uint32_t i) { return cut.patches().centroid[i].y < 0.5f; };
  const auto above = [&](uint32_t i) { return !below(i); };
  const double exact =
      viewfactor::polygon_form_factor(Polygon{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                                      Polygon{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}});
  EXPECT_NEAR(exact, 0.1998249, 1e-7);  // Howell, C-11, a square on a square at its distance
  // 100 patches x 1000 rays: sqrt(0.2 * 0.8 / 100000) = 0.0013 for independent ones.
  EXPECT_NEAR(factor_between(cut, traced, below, above), exact, 3 * 0.0013);
  EXPECT_NEAR(factor_between(cut, both, below, above), exact, 3 * 0.0013);
  EXPECT_EQ(factor_between(cut, both, below, below), 0);
}

TEST(TraceFactors, WallsOfACubeByTheClosedForm) {
  const Cut cut(room(), 300);
  const FormFactors f = cut.reciprocal_factors(1000);
  // Neighbours share an edge, where a patch of one is near one of the other: 1/4 less a twentieth.
  const double neighbours =
      viewfactor::polygon_form_factor(Polygon{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                                      Polygon{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}});
  EXPECT_NEAR(neighbours, (1 - 0.1998249) / 4, 1e-7);
  const auto faces = [&](Vec3 way) {
    return [&cut, way](uint32_t i) { return dot(cut.patches().elements.normal[i], way) > 0.9f; };
  };
  // 50 patches x 1000 rays: sqrt(0.16 / 50000) = 0.0018.
  for (const Vec3 side : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
    EXPECT_NEAR(factor_between(cut, f, faces({0, 1, 0}), faces(side)), neighbours, 3 * 0.0018);
  EXPECT_NEAR(factor_between(cut, f, faces({0, 1, 0}), faces({0, -1, 0})), 0.1998249, 3 * 0.0018);
}

TEST(Reciprocal, IsReciprocal) {
  for (const scene::Scene& scene : {room(), scene::cornell_box(), scene::spheres_and_cube()}) {
    const Cut cut(scene, 300);
    const FormFactors f = cut.reciprocal_factors(256);
    expect_ascending(f);
    for (uint32_t i = 0; i < f.size(); ++i)
      for (const uint32_t j : f.columns_of(i)) {
        const double there = double(cut.patches().area_m2[i]) * double(entry(f, i, j));
        const double back = double(cut.patches().area_m2[j]) * double(entry(f, j, i));
        // Each is rounded a few times, to 6e-8 of itself.
        ASSERT_NEAR(there, back, 4e-7 * there) << i << ", " << j;
      }
  }
}

TEST(Reciprocal, KeepsRowSums) {
  for (const scene::Scene& scene : {room(), scene::cornell_box(), scene::spheres_and_cube()}) {
    const Cut cut(scene, 300);
    const TracedFactors traced = cut.traced(1024);
    const FormFactors f = reciprocal(traced.factors, cut.patches().area_m2);
    for (size_t i = 0; i < f.size(); ++i) {
      EXPECT_LE(row_sum(f, i), 1 + 1e-6);  // the sum of hundreds of floats
      EXPECT_NEAR(row_sum(f, i), row_sum(traced.factors, i), 1e-3) << scene.name << " " << i;
    }
  }
}

TEST(Reciprocal, LeavesAReciprocalMatrixAsItIs) {
  std::vector<float> area;
  for (const Rgb& c : testing::random_light(40, 1)) area.push_back(0.1f + c.x);
  const FormFactors f = testing::sphere_factors(area), again = reciprocal(f, area);
  EXPECT_EQ(f.column, again.column);
  for (size_t k = 0; k < f.factor.size(); ++k)
    EXPECT_NEAR(f.factor[k], again.factor[k], 1e-6f * f.factor[k]);
}

TEST(TraceFactors, SameBitsForAnyNumberOfThreads) {
  const Cut cut(scene::cornell_box(), 300);
  const auto factors = [&](int threads) {
    const ThreadLimit limit(threads);
    return cut.reciprocal_factors(256);
  };
  const FormFactors one = factors(1);
  for (const int threads : {2, 7}) {
    const FormFactors other = factors(threads);
    EXPECT_EQ(one.first, other.first);
    EXPECT_EQ(one.column, other.column);
    EXPECT_EQ(one.factor, other.factor);
  }
}

TEST(TraceFactors, CanBeCancelled) {
  const Cut cut(testing::plate(), 50);
  Progress progress;
  progress.request_cancel();
  const auto traced = trace_factors(cut.scene, cut.tracer, cut.patched, {}, progress);
  ASSERT_FALSE(traced);
  EXPECT_EQ(traced.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::matrix
