#include "luxel/solve/matrix/colour_matrix.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/bounces.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

/// Data that a matrix is made of.
struct ColourRoom {
  FormFactors factors;
  std::vector<float> area_m2;
  std::vector<Rgb> reflectance, sent;

  /// By one product after another.
  std::vector<Rgb> counted(int bounces) const {
    std::vector<Rgb> out(sent.size());
    BounceScratch scratch = make_bounce_scratch(sent.size(), 0);
    const Multiply plain = [this](std::span<const Rgb> b, std::span<Rgb> e) {
      testing::plain_product(factors, b, e);
    };
    count_bounces(plain, {sent, reflectance, area_m2, bounces}, out, scratch);
    return out;
  }
  ColourMatrix matrix(int bounces) const {
    Progress progress;
    auto made = make_reflections(factors, reflectance, area_m2, bounces, progress);
    EXPECT_TRUE(made);
    return made ? std::move(*made) : ColourMatrix{};
  }
};

std::vector<Rgb> product(const ColourMatrix& matrix, std::span<const Rgb> b) {
  std::vector<Rgb> out(b.size());
  DenseScratch scratch = make_dense_scratch(b.size());
  multiply(matrix, b, out, scratch);
  return out;
}

/// The Cornell box with light of every patch's own, not a multiple of any width of vectors or
/// panels.
const ColourRoom& cornell() {
  static const ColourRoom room = [] {
    const Cut cut(scene::cornell_box(), 300);
    return ColourRoom{cut.reciprocal_factors(1024), cut.patches().area_m2,
                      copied(cut.patches().elements.reflectance),
                      testing::random_light(cut.size(), 1)};
  }();
  return room;
}

/// The inside of a sphere of patches of all sizes: F_ij = A_j / A.
ColourRoom sphere(Rgb reflectance) {
  ColourRoom room;
  for (const Rgb& c : testing::random_light(150, 2)) room.area_m2.push_back(0.1f + c.x);
  room.factors = testing::sphere_factors(room.area_m2);
  room.reflectance.assign(150, reflectance);
  room.sent.assign(150, Rgb{1, 2, 3});
  return room;
}

TEST(Reflections, AreCountedBouncesInOneProduct) {
  for (int bounces = 1; bounces <= 6; ++bounces) {
    const std::vector<Rgb> want = cornell().counted(bounces),
                           got = product(cornell().matrix(bounces), cornell().sent);
    // Sums of 300 floats, nested.
    for (size_t i = 0; i < want.size(); ++i)
      EXPECT_LE(length(got[i] - want[i]), 3e-6f * length(want[i])) << bounces << ", " << i;
  }
}

TEST(Reflections, WithoutEndAreTheLimit) {
  // 0.75^300 of the light is still to come: none.
  const std::vector<Rgb> want = cornell().counted(300),
                         got = product(cornell().matrix(-1), cornell().sent);
  // A factorisation in float. F is reciprocal in float; K is made of what lies on one side.
  for (size_t i = 0; i < want.size(); ++i)
    EXPECT_LE(length(got[i] - want[i]), 2e-5f * length(want[i])) << i;
}

TEST(Reflections, SeriesInAFurnace) {
  // All send e and reflect rho: E_k = e (1 - rho^k) / (1 - rho), without end e / (1 - rho).
  const Rgb rho{0.2f, 0.5f, 0.9f};
  const ColourRoom room = sphere(rho);
  for (const int bounces : {1, 2, 3, 6, -1})
    for (const Rgb& e : product(room.matrix(bounces), room.sent))
      for (int c = 0; c < 3; ++c) {
        const float left = bounces < 0 ? 0.0f : std::pow(rho[c], float(bounces));
        const float want = room.sent[0][c] * (1 - left) / (1 - rho[c]);
        EXPECT_NEAR(e[c], want, 2e-5f * want) << bounces;  // floats, and 1 / (1 - rho) of 10
      }
}

TEST(Reflections, WithoutEndNeedNoColour) {
  // Nothing is divided by reflectances: black patches receive all the same.
  ColourRoom room = cornell();
  for (size_t i = 0; i < room.sent.size(); i += 3) room.reflectance[i] = {0, 0, 0.5f};
  const std::vector<Rgb> want = room.counted(300), got = product(room.matrix(-1), room.sent);
  for (size_t i = 0; i < want.size(); ++i)
    EXPECT_LE(length(got[i] - want[i]), 2e-5f * length(want[i])) << i;
}

TEST(Reflections, AreReciprocal) {
  // A_i K_ij = A_j K_ji, against the largest entry.
  for (const int bounces : {3, -1}) {
    const ColourMatrix k = cornell().matrix(bounces);
    const std::vector<float>& a = cornell().area_m2;
    for (const auto& m : k.channel) {
      const float largest = *std::max_element(m.begin(), m.end());
      for (size_t i = 0; i < k.n; ++i)
        for (size_t j = 0; j < i; ++j)
          EXPECT_NEAR(a[i] * m[i * k.n + j], a[j] * m[j * k.n + i], 1e-5f * a[i] * largest);
    }
  }
}

TEST(ColourFactors, BringOneBounceMore) {
  // [Shcherbakov17, eq. 6, 7]: incident^(h) = F^c incident^(h-1).
  const ColourMatrix f = make_colour_factors(cornell().factors, cornell().reflectance);
  std::vector<Rgb> incident = product(f, cornell().sent), sent = cornell().sent;
  for (int h = 0; h < 4; ++h) {
    for (size_t i = 0; i < sent.size(); ++i) sent[i] = cornell().reflectance[i] * sent[i];
    const std::vector<Rgb> want = testing::plain_product(cornell().factors, sent);
    for (size_t i = 0; i < want.size(); ++i)
      EXPECT_LE(length(incident[i] - want[i]), 3e-6f * length(want[i]));  // sums of floats
    sent = want;
    incident = product(f, incident);
  }
}

TEST(Reflections, CountTheirBytes) {
  const ColourMatrix k = cornell().matrix(1);
  EXPECT_EQ(bytes_of(k), 12 * uint64_t(k.n) * k.n);
}

TEST(Reflections, SameBitsForAnyNumberOfThreads) {
  for (const int bounces : {3, -1}) {
    const auto light = [&](int threads) {
      const ThreadLimit limit(threads);
      const ColourMatrix k = cornell().matrix(bounces);
      EXPECT_EQ(product(k, cornell().sent).size(), k.size());
      return std::pair(k.channel, product(k, cornell().sent));
    };
    const auto one = light(1);
    EXPECT_EQ(one, light(2));
    EXPECT_EQ(one, light(7));
  }
}

TEST(Reflections, CanBeCancelled) {
  Progress progress;
  progress.request_cancel();
  for (const int bounces : {3, -1}) {
    const auto k = make_reflections(cornell().factors, cornell().reflectance, cornell().area_m2,
                                    bounces, progress);
    ASSERT_FALSE(k);
    EXPECT_EQ(k.error().code, ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace luxel::matrix
