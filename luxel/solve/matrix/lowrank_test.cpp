#include "luxel/solve/matrix/lowrank.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/bounces.h"
#include "luxel/solve/matrix/matrix_test_support.h"
#include "luxel/solve/matrix/tall_matrix.h"

namespace luxel::matrix {
namespace {

using Dense64 = Eigen::MatrixXd;

/// Data that the codec is made from.
struct LowrankRoom {
  FormFactors factors;
  std::vector<float> area_m2;
  std::vector<Rgb> reflectance, sent;

  size_t size() const { return area_m2.size(); }
  Spectrum spectrum(uint32_t count, int iterations = 2) const {
    Progress progress;
    auto out = spectrum_of(factors, area_m2, {count, iterations, 1}, progress);
    EXPECT_TRUE(out);
    return out ? std::move(*out) : Spectrum{};
  }
  LowRank codec(const Spectrum& s, size_t rank) const {
    Progress progress;
    auto out = make_low_rank(s, rank, area_m2, reflectance, progress);
    EXPECT_TRUE(out);
    return out ? std::move(*out) : LowRank{};
  }
  std::vector<Rgb> light(const LowRank& m, int bounces) const {
    std::vector<Rgb> out(size());
    LowRankScratch scratch = make_scratch(m);
    irradiance_of(m, sent, bounces, out, scratch);
    return out;
  }
  /// sum A_i x_i / A, per channel.
  Rgb mean(std::span<const Rgb> x) const {
    Rgb sum{};
    for (size_t i = 0; i < x.size(); ++i) sum += x[i] * area_m2[i];
    return sum / float(testing::sum_of(area_m2));
  }
  /// sqrt(sum A_i x_i^2) over all channels.
  double norm(std::span<const Rgb> x) const {
    double sum = 0;
    for (size_t i = 0; i < x.size(); ++i)
      sum += double(area_m2[i]) * double(luxel::dot(x[i], x[i]));
    return std::sqrt(sum);
  }
  /// A^1/2 F A^-1/2.
  Dense64 symmetric() const {
    Dense64 out = Dense64::Zero(Eigen::Index(size()), Eigen::Index(size()));
    for (size_t i = 0; i < size(); ++i)
      for (size_t k = 0; k < factors.columns_of(i).size(); ++k) {
        const uint32_t j = factors.columns_of(i)[k];
        out(Eigen::Index(i), j) =
            double(factors.factors_of(i)[k]) * std::sqrt(double(area_m2[i]) / double(area_m2[j]));
      }
    return out;
  }
};

/// The inside of a sphere whose patches differ in size, colour and light: F_ij = A_j / A, rank 1.
LowrankRoom lowrank_sphere(size_t count) {
  LowrankRoom room;
  for (const Rgb& c : testing::random_light(count, 2)) room.area_m2.push_back(0.1f + c.x);
  room.factors = testing::sphere_factors(room.area_m2);
  room.reflectance = testing::random_light(count, 3);
  room.sent = testing::random_light(count, 4);
  return room;
}

const LowrankRoom& lowrank_cornell() {
  static const LowrankRoom room = [] {
    const testing::Cut cut(scene::cornell_box(), 400);
    return LowrankRoom{cut.reciprocal_factors(1024), cut.patches().area_m2,
                       copied(cut.patches().elements.reflectance),
                       testing::random_light(cut.size(), 5)};
  }();
  return room;
}
/// All of it.
const Spectrum& cornell_spectrum() {
  static const Spectrum spectrum = lowrank_cornell().spectrum(uint32_t(lowrank_cornell().size()));
  return spectrum;
}

TEST(Orthonormal, KeepsTheSpanAndDropsWhatDepends) {
  // Seven columns, two of them combinations of the others, and one that nearly is.
  const Progress progress;
  Tall a = Tall::Random(1000, 7);
  a.col(2) = a.col(0) - 3 * a.col(5), a.col(4) = 2 * a.col(1);
  a.col(6) = a.col(3) + 2e-5f * a.col(6);
  const Tall q = orthonormal(a, progress);
  ASSERT_EQ(q.cols(), 5);
  const Dense64 gram = inner_products(q, q, progress);
  // Entries are floats: 6e-8 each, of sums of 1000 squares that add up to 1.
  EXPECT_LT((gram - Dense64::Identity(5, 5)).norm(), 2e-7);
  const Dense64 inside = q.cast<double>() * inner_products(q, a, progress);
  EXPECT_LT((inside - a.cast<double>()).norm(), 1e-6 * a.cast<double>().norm());
}

TEST(Spectrum, OfASphereIsOneNumber) {
  const LowrankRoom room = lowrank_sphere(200);
  const Spectrum s = room.spectrum(8);
  ASSERT_EQ(rank_above(s, 1e-5f), 1u);
  EXPECT_NEAR(s.value[0], 1, 2e-6);  // sums of 200 floats
  EXPECT_NEAR(s.energy, 1, 2e-6);    // the square of it
  EXPECT_LT(lost(s, 1), 3e-3);       // the root of what 1 - 1 leaves of 2e-6 twice
  const double whole = testing::sum_of(room.area_m2), sign = s.vector[0] > 0 ? 1 : -1;
  for (size_t i = 0; i < room.size(); ++i)
    EXPECT_NEAR(s.vector[i * s.count()], sign * std::sqrt(double(room.area_m2[i]) / whole), 1e-6);
}

TEST(Spectrum, OfNothingIsEmpty) {
  // A plate that sees only the sky.
  LowrankRoom room;
  room.area_m2 = {1, 2, 3}, room.factors.first = {0, 0, 0, 0};
  room.reflectance.assign(3, {0.5f, 0.5f, 0.5f}), room.sent.assign(3, {1, 1, 1});
  const Spectrum s = room.spectrum(8);
  EXPECT_EQ(s.count(), 0u);
  EXPECT_EQ(lost(s, 0), 0);
  for (const int bounces : {-1, 0, 1, 5})
    EXPECT_EQ(room.light(room.codec(s, 0), bounces), std::vector<Rgb>(3));
}

TEST(Spectrum, IsThatOfTheDenseMatrix) {
  const Eigen::SelfAdjointEigenSolver<Dense64> solver(lowrank_cornell().symmetric());
  std::vector<double> want(solver.eigenvalues().begin(), solver.eigenvalues().end());
  std::sort(want.begin(), want.end(), [](double a, double b) { return std::abs(a) > std::abs(b); });
  double square = 0;
  for (const double v : want) square += v * v;
  EXPECT_NEAR(cornell_spectrum().energy, square, 1e-6 * square);
  // In the whole space nothing is left to chance; S is symmetric to the rounding of its floats.
  ASSERT_EQ(cornell_spectrum().count(), lowrank_cornell().size());
  for (size_t k = 0; k < want.size(); ++k)
    EXPECT_NEAR(std::abs(cornell_spectrum().value[k]), std::abs(want[k]), 2e-6) << k;
  // In a subspace of 24 + 16 they are found too small, by the square of what is missing of the
  // vector: each product takes the part of eigenvalue 41 to that of k, squared, of what there was
  // at first, the random start's some 100.
  for (const int iterations : {0, 2, 15}) {
    const Spectrum part = lowrank_cornell().spectrum(24, iterations);
    for (size_t k = 0; k < 24; ++k) {
      const double missing = 100 * std::pow(std::abs(want[40] / want[k]), 2.0 * (iterations + 1));
      EXPECT_LT(std::abs(part.value[k]), std::abs(want[k]) + 2e-6) << k;
      EXPECT_GT(std::abs(part.value[k]), (1 - missing) * std::abs(want[k]) - 2e-6) << k;
    }
  }
}

TEST(Spectrum, KnowsWhatItLoses) {
  const Dense64 s = lowrank_cornell().symmetric();
  const Spectrum& spectrum = cornell_spectrum();
  const auto n = Eigen::Index(lowrank_cornell().size());
  const Eigen::Map<const Tall> v(spectrum.vector.data(), n, n);
  const Eigen::Map<const Eigen::VectorXf> value(spectrum.value.data(), n);
  for (const Eigen::Index rank : {1, 7, 40, 200}) {
    const Dense64 kept = v.leftCols(rank).cast<double>() *
                         value.head(rank).cast<double>().asDiagonal() *
                         v.leftCols(rank).cast<double>().transpose();
    EXPECT_NEAR(lost(spectrum, size_t(rank)), (s - kept).norm() / s.norm(), 1e-5) << rank;
  }
}

TEST(LowRank, CountsBouncesInASphere) {
  // E = <sent> (1 + <rho> + ... + <rho>^(k-1)), see bounces_test.cpp.
  const LowrankRoom room = lowrank_sphere(700);
  const LowRank m = room.codec(room.spectrum(4), 1);
  EXPECT_EQ(m.rank(), kRankLanes);
  const Rgb sent = room.mean(room.sent), rho = room.mean(room.reflectance);
  for (const int bounces : {1, 2, 7, -1})
    for (const Rgb& e : room.light(m, bounces))
      for (int c = 0; c < 3; ++c) {
        const float gone = bounces < 0 ? 0 : std::pow(rho[c], float(bounces));
        const float want = sent[c] * (1 - gone) / (1 - rho[c]);
        // Entries are rounded to 1/65534 of the largest, and the smallest is 0.3 of that.
        EXPECT_NEAR(e[c], want, 6e-5f * want) << bounces;
      }
}

TEST(LowRank, FurnaceIsExact) {
  // All emit e and reflect rho: E = B = e / (1 - rho).
  LowrankRoom room = lowrank_sphere(300);
  const Rgb rho{0.2f, 0.5f, 0.95f};
  std::fill(room.reflectance.begin(), room.reflectance.end(), rho);
  std::fill(room.sent.begin(), room.sent.end(), Rgb{1, 2, 3});
  for (const Rgb& e : room.light(room.codec(room.spectrum(4), 1), -1)) {
    EXPECT_NEAR(e.x, 1 / 0.8f, 6e-5 * 1 / 0.8);  // rounding of the vector, as above
    EXPECT_NEAR(e.y, 2 / 0.5f, 6e-5 * 2 / 0.5);
    EXPECT_NEAR(e.z, 3 / 0.05f, 1e-4 * 3 / 0.05);  // which 0.95 / 0.05 makes more of
  }
}

/// (I - F R) E = F B, channel by channel.
std::vector<Rgb> solved(const LowrankRoom& room, const Dense64& f) {
  const auto n = Eigen::Index(room.size());
  std::array<Eigen::VectorXd, 3> light;
  for (int c = 0; c < 3; ++c) {
    Eigen::VectorXd rho(n), sent(n);
    for (Eigen::Index i = 0; i < n; ++i)
      rho[i] = double(room.reflectance[size_t(i)][c]), sent[i] = double(room.sent[size_t(i)][c]);
    const Dense64 system = Dense64::Identity(n, n) - f * rho.asDiagonal();
    light[size_t(c)] = system.partialPivLu().solve(f * sent);
  }
  std::vector<Rgb> out;
  for (Eigen::Index i = 0; i < n; ++i)
    out.push_back({float(light[0][i]), float(light[1][i]), float(light[2][i])});
  return out;
}

TEST(LowRank, OfFullRankIsTheDenseSolution) {
  const LowrankRoom& room = lowrank_cornell();
  const Eigen::Map<const Eigen::VectorXf> area(room.area_m2.data(), Eigen::Index(room.size()));
  const Eigen::VectorXd root = area.cast<double>().cwiseSqrt();
  const Dense64 f = root.cwiseInverse().asDiagonal() * room.symmetric() * root.asDiagonal();
  const LowRank m = room.codec(cornell_spectrum(), room.size());
  const std::vector<Rgb> got = room.light(m, -1);
  // Vectors in 16 bits.
  EXPECT_LT(testing::relative_error(got, solved(room, f), room.area_m2), 3e-4);
}

TEST(LowRank, BouncesAreThoseOfItsOwnMatrix) {
  // Whatever the vectors are: F = A^-1/2 V L V^T A^1/2 written out, its bounces one by one.
  // Light of one patch: so few vectors make it ring below zero.
  LowrankRoom room = lowrank_cornell();
  std::fill(room.sent.begin(), room.sent.end(), Rgb{});
  room.sent[room.size() / 2] = {1, 2, 3};
  const LowRank m = room.codec(cornell_spectrum(), 20);
  EXPECT_EQ(m.rank(), 2 * kRankLanes);
  const Multiply product = [&](std::span<const Rgb> b, std::span<Rgb> e) {
    std::vector<std::array<double, 3>> sum(m.rank(), {0, 0, 0});
    for (size_t i = 0; i < m.size(); ++i)
      for (size_t k = 0; k < m.rank(); ++k)
        for (int c = 0; c < 3; ++c)
          sum[k][size_t(c)] += double(m.vector[i * m.rank() + k]) * double(m.root_area_m[i]) *
                               double(b[i][c]) * double(m.eigenvalue[k]);
    for (size_t i = 0; i < m.size(); ++i) {
      std::array<double, 3> light{};
      for (size_t k = 0; k < m.rank(); ++k)
        for (size_t c = 0; c < 3; ++c)
          light[c] += double(m.vector[i * m.rank() + k]) * sum[k][c] / double(m.root_area_m[i]);
      e[i] = {float(light[0]), float(light[1]), float(light[2])};
    }
  };
  BounceScratch scratch = make_bounce_scratch(room.size(), 0);
  for (const int bounces : {0, 1, 2, 5, 200}) {
    std::vector<Rgb> want(room.size());
    count_bounces(product, {room.sent, room.reflectance, room.area_m2, bounces}, want, scratch);
    float largest = 0, smallest = 0;
    for (Rgb& e : want) {
      largest = std::max(largest, max_component(e)),
      smallest = std::min(smallest, min_component(e));
      e = max(e, Rgb{});
    }
    EXPECT_EQ(smallest<0, bounces> 0);
    // Sums of 400 floats. 0.7^200 is nothing: after 200 bounces all have been.
    for (const int asked : {bounces, bounces == 200 ? -1 : bounces}) {
      const std::vector<Rgb> got = room.light(m, asked);
      for (size_t i = 0; i < want.size(); ++i)
        EXPECT_LE(max_component(max(got[i] - want[i], want[i] - got[i])), 2e-5f * largest) << asked;
    }
  }
}

TEST(LowRank, ErrsLessThanTheFirstEigenvalueLeftOut) {
  const LowrankRoom& room = lowrank_cornell();
  const std::vector<Rgb> exact = testing::plain_product(room.factors, room.sent);
  double before = 1;
  for (const size_t rank : {1u, 4u, 16u, 64u, 128u, 256u}) {
    const std::vector<Rgb> got = room.light(room.codec(cornell_spectrum(), rank), 1);
    std::vector<Rgb> difference(got.size());
    for (size_t i = 0; i < got.size(); ++i) difference[i] = got[i] - exact[i];
    const double error = room.norm(difference) / room.norm(room.sent);
    // Vectors in 16 bits add to what is left out.
    EXPECT_LT(error, double(std::abs(cornell_spectrum().value[rank])) + 1e-4) << rank;
    EXPECT_LT(error, before) << rank;
    before = error;
  }
}

TEST(LowRank, SameBitsForAnyNumberOfThreads) {
  const auto made = [](int threads) {
    const ThreadLimit limit(threads);
    const LowRank m = lowrank_cornell().codec(lowrank_cornell().spectrum(32), 32);
    return std::tuple(m.vector, m.eigenvalue, m.all_bounces, lowrank_cornell().light(m, -1),
                      lowrank_cornell().light(m, 3));
  };
  const auto one = made(1);
  EXPECT_EQ(one, made(2));
  EXPECT_EQ(one, made(5));
}

TEST(LowRank, CanBeCancelled) {
  Progress progress;
  progress.request_cancel();
  const LowrankRoom& room = lowrank_cornell();
  const auto spectrum = spectrum_of(room.factors, room.area_m2, {}, progress);
  ASSERT_FALSE(spectrum);
  EXPECT_EQ(spectrum.error().code, ErrorCode::cancelled);
  const auto m = make_low_rank(cornell_spectrum(), 8, room.area_m2, room.reflectance, progress);
  ASSERT_FALSE(m);
  EXPECT_EQ(m.error().code, ErrorCode::cancelled);
}

TEST(Spectrum, OfNoneWantedIsAnError) {
  Progress progress;
  const auto none = spectrum_of(lowrank_cornell().factors, lowrank_cornell().area_m2,
                                {.count = 0, .iterations = 2, .seed = 1}, progress);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::bad_setting);
}

}  // namespace
}  // namespace luxel::matrix
