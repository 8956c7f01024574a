#include "luxel/viewfactor/sampled_factors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/polygon_form_factor.h"
#include "luxel/viewfactor/polygon_test_support.h"
#include "luxel/viewfactor/surface_sampler.h"
#include "tests/reference_data.h"

namespace luxel::viewfactor {
namespace {

namespace shared = luxel::testing_support;

const Polygon kFloor{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const Polygon kCeiling{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}};

Hemicube hemicube_of(int resolution) {
  Progress progress;
  return *make_hemicube(resolution, progress);
}

TEST(Hemicube, PixelsShareTheHemisphere) {
  for (const int n : {2, 4, 16, 64}) {
    const Hemicube cube = hemicube_of(n);
    ASSERT_EQ(cube.direction.size(), size_t(3 * n * n));
    ASSERT_EQ(cube.delta_factor.size(), cube.direction.size());
    EXPECT_NEAR(std::accumulate(cube.delta_factor.begin(), cube.delta_factor.end(), 0.0), 1, 1e-14);
    // The top covers F = (4 / pi) (1/sqrt 2) atan(1/sqrt 2) of it: four corners by Howell's B-3.
    const double top =
        std::accumulate(cube.delta_factor.begin(), cube.delta_factor.begin() + n * n, 0.0);
    EXPECT_NEAR(top, 4 / kPiDouble * std::atan(1 / std::sqrt(2.0)) / std::sqrt(2.0), 1e-12);
    for (size_t k = 0; k < cube.direction.size(); ++k) {
      EXPECT_NEAR(length(cube.direction[k]), 1, 1e-6);
      EXPECT_GT(cube.direction[k].z, 0);
      EXPECT_GT(cube.delta_factor[k], 0);
    }
  }
}

// Each pixel's share is that of its solid angle times the cosine: the classic formulas for small
// pixels. [Cohen85, section 3]
TEST(Hemicube, SmallPixelsHaveCohensDeltaFactors) {
  const int n = 256;
  const Hemicube cube = hemicube_of(n);
  const double pixel = 4.0 / n / n;
  for (const size_t k : {size_t(0), size_t(300), size_t(n * n / 2 + 77), size_t(n * n + 12345),
                         size_t(3 * n * n - 999)}) {
    // A pixel at distance r along a unit direction d: area * (d . face normal) * d.z / (pi r^2).
    const Vec3 d = cube.direction[k];
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    const double r = 1 / largest;
    EXPECT_NEAR(cube.delta_factor[k], pixel * largest * d.z / (kPiDouble * r * r),
                1e-3 * cube.delta_factor[k])
        << k;
  }
}

TEST(Hemicube, TheLargestOneStopsWhenAsked) {
  Progress progress;
  progress.request_cancel();
  const auto cube = make_hemicube(4096, progress);
  ASSERT_FALSE(cube.has_value());
  EXPECT_EQ(cube.error().code, ErrorCode::cancelled);
}

// Between the bounds of the binomial distribution, and honest where nothing or everything was hit:
// with the chance 3 / n for each of n rays, none hits in 5 of 100 cases.
TEST(StandardErrorOfShare, IsThatOfTheBinomialAndNeverZero) {
  EXPECT_NEAR(standard_error_of_share(0.3, 1e6), std::sqrt(0.3 * 0.7 / 1e6), 1e-8);
  for (const double n : {64.0, 256.0, 262144.0})
    for (const double share : {0.0, 1.0}) {
      EXPECT_GT(2 * standard_error_of_share(share, n), 0.9 * 3 / (n + 4));
      EXPECT_LT(2 * standard_error_of_share(share, n), 1.1 * 3 / n);
    }
}

// Two hundred surveys of a small share by 64 rays: few are further off than twice the error, though
// a quarter of them hits nothing at all.
TEST(StandardErrorOfShare, CoversTheTruthWhereHitsAreRare) {
  const double truth = 0.02;
  int off = 0, empty = 0;
  Dice dice;
  for (int survey = 0; survey < 400; ++survey) {
    int hits = 0;
    for (int k = 0; k < 64; ++k) hits += std::abs(dice.number()) < truth;
    empty += hits == 0;
    const double share = hits / 64.0;
    off += std::abs(share - truth) > 2 * standard_error_of_share(share, 64);
  }
  EXPECT_GT(empty, 60);
  EXPECT_LT(off, 40);
}

// A point that stands for the whole surface knows nothing of the others.
TEST(SampledFactors, OneHemicubeClaimsNoCertainty) {
  const double exact = polygon_form_factor(kFloor, kCeiling);
  for (uint64_t seed = 1; seed < 20; ++seed) {
    const auto one =
        sampled_form_factor(kFloor, kCeiling, {}, {.samples = 1, .hemicube = 32, .seed = seed});
    EXPECT_GT(one->error, 0.1);
    EXPECT_NEAR(one->value, exact, 2 * one->error);
  }
  const Polygon behind{{0, 1, -1}, {1, 1, -1}, {1, 0, -1}, {0, 0, -1}};
  const auto none = sampled_form_factor(kFloor, behind, {}, {.samples = 16, .hemicube = 32});
  EXPECT_EQ(none->value, 0);
  EXPECT_GT(none->error, 0);
  EXPECT_LT(none->error, 1e-4);
}

/// Root mean square over some seeds of a method's error at a level of effort.
template <class Error>
double rms(int seeds, const Error& error) {
  double squares = 0;
  for (int s = 1; s <= seeds; ++s) squares += std::pow(error(uint64_t(s)), 2);
  return std::sqrt(squares / seeds);
}

// A hemicube counts the pixels whose centres see the polygon. Only those on its outline are wrong,
// n of 3 n^2, each by half of itself, with random signs: the error falls like n^-1.5.
TEST(SampledFactorsSlow, HemicubeErrorFallsWithResolution) {
  const double exact = point_to_polygon(DVec3{0.3, 0.4, 0}, DVec3{0, 0, 1}, kCeiling);
  const auto error_at = [&](int resolution) {
    return rms(24, [&](uint64_t seed) {
      const auto factor = sampled_point_factor({0.3, 0.4, 0}, {0, 0, 1}, kCeiling, {},
                                               {.hemicube = resolution, .seed = seed});
      return factor->value - exact;
    });
  };
  const double coarse = error_at(16), fine = error_at(256);
  const double rate = std::log(coarse / fine) / std::log(16.0);
  EXPECT_GT(rate, 1.2);
  EXPECT_LT(rate, 1.9);
  EXPECT_LT(fine, 5e-4);
}

// Independent rays would bring n^-0.5; stratified ones do better, but no worse.
TEST(SampledFactorsSlow, RaysErrorFallsWithSamples) {
  const double exact = polygon_form_factor(kFloor, kCeiling);
  const auto error_at = [&](uint32_t samples) {
    return rms(24, [&](uint64_t seed) {
      return sampled_form_factor(kFloor, kCeiling, {}, {.samples = samples, .seed = seed})->value -
             exact;
    });
  };
  const double few = error_at(256), many = error_at(65536);
  const double rate = std::log(few / many) / std::log(256.0);
  EXPECT_GT(rate, 0.45);
  EXPECT_LT(rate, 1.1);
  EXPECT_LT(many, std::sqrt(exact * (1 - exact) / 65536));
}

TEST(SampledFactorsSlow, MatchTheExactTableWithinTheirError) {
  for (const auto& row : shared::csv_rows("reference/view-factors.csv")) {
    const Polygon a = shared::parse_polygon(row[2]), b = shared::parse_polygon(row[3]);
    const std::vector<Polygon> blockers = shared::parse_polygons(row[4]);
    const double exact = std::stod(row[5]);
    const auto sample = [&](const SampledParams& params) {
      return row[1] == "poly" ? sampled_form_factor(a, b, blockers, params)
                              : sampled_point_factor(a[0], a[1], b, blockers, params);
    };
    const auto rays = sample({.samples = 1u << 16});
    EXPECT_NEAR(rays->value, exact, 4 * rays->error + 1e-4) << row[0];
    const auto hemicube = sample({.samples = 64, .hemicube = 64});
    EXPECT_NEAR(hemicube->value, exact, 4 * hemicube->error + 3e-3) << row[0];
  }
}

TEST(StratifiedNumbers, EachPairIsStratifiedAndThePairsAreIndependent) {
  // 16 x 16 cells of (first.x, second.x): 4096 numbers that knew of each other would leave holes.
  std::vector<int> cell(256);
  std::vector<int> strata_first(4096), strata_second(4096);
  for (uint32_t k = 0; k < 4096; ++k) {
    const FourNumbers at = stratified_4d(k, 7);
    ++cell[size_t(at.first.x * 16) * 16 + size_t(at.second.x * 16)];
    ++strata_first[size_t(at.first.x * 4096)];
    ++strata_second[size_t(at.second.y * 4096)];
  }
  for (const int count : strata_first) EXPECT_EQ(count, 1);
  for (const int count : strata_second) EXPECT_EQ(count, 1);
  double chi2 = 0;  // about 225 for independent ones, 255 degrees of freedom less the margins
  for (const int count : cell) chi2 += (count - 16.0) * (count - 16.0) / 16.0;
  EXPECT_LT(chi2, 340);
}

}  // namespace
}  // namespace luxel::viewfactor
