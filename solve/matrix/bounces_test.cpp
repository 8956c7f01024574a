#include "solve/matrix/bounces.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

Multiply plain(const FormFactors& f) {
  return [&f](std::span<const Rgb> b, std::span<Rgb> e) { testing::plain_product(f, b, e); };
}

/// What bounces are made of.
struct Room {
  FormFactors factors;
  ClusterTree tree;
  std::vector<float> area_m2;
  std::vector<Rgb> reflectance, sent;

  std::vector<Rgb> counted(int bounces) const {
    std::vector<Rgb> out(sent.size());
    BounceWork work = make_bounce_work(sent.size(), 0);
    count_bounces(plain(factors), reflectance, sent, bounces, out, work);
    return out;
  }
  std::vector<Rgb> all(int sweeps, size_t clusters) const {
    const CoarseScene coarse = make_coarse_scene(factors, tree, area_m2, reflectance, clusters);
    std::vector<Rgb> out(sent.size());
    BounceWork work = make_bounce_work(sent.size(), coarse.count());
    all_bounces(plain(factors), coarse, reflectance, area_m2, sent, sweeps, out, work);
    return out;
  }
  /// sum A_i x_i / A, per channel.
  Rgb mean(std::span<const Rgb> x) const {
    Rgb sum{};
    for (size_t i = 0; i < x.size(); ++i) sum += x[i] * area_m2[i];
    return sum / float(testing::sum_of(area_m2));
  }
};

/// The inside of a sphere whose patches differ in size, colour and light: F_ij = A_j / A.
Room sphere(size_t count) {
  Room room;
  std::vector<Vec3> position = testing::random_light(count, 1), normal;
  for (Vec3& p : position) p = normalize(p - Vec3{0.5f, 0.5f, 0.5f}), normal.push_back(-p);
  room.tree = make_cluster_tree(position, normal, kLeafSize);
  for (const Rgb& c : testing::random_light(count, 2)) room.area_m2.push_back(0.1f + c.x);
  room.factors = testing::sphere_factors(room.area_m2);
  room.reflectance = testing::random_light(count, 3);
  room.sent = testing::random_light(count, 4);
  return room;
}

Room cornell(size_t count) {
  const Cut cut(scene::cornell_box(), count);
  return {cut.reciprocal_factors(1024), cut.work.tree, cut.patches().area_m2,
          cut.patches().elements.reflectance, cut.patches().emission};
}

TEST(CountBounces, IsTheSumOverReflections) {
  // [Shcherbakov17, eq. 3, 4 and 8]: what arrives is reflected, and arrives again; the sum of all.
  const Room room = cornell(200);
  std::vector<Rgb> excident = room.sent, total(room.sent.size());
  EXPECT_EQ(room.counted(0), total);
  for (int bounces = 1; bounces <= 5; ++bounces) {
    const std::vector<Rgb> incident = testing::plain_product(room.factors, excident);
    for (size_t i = 0; i < total.size(); ++i)
      total[i] += incident[i], excident[i] = incident[i] * room.reflectance[i];
    const std::vector<Rgb> got = room.counted(bounces);
    // The same sums in another order.
    for (size_t i = 0; i < total.size(); ++i)
      EXPECT_LE(length(got[i] - total[i]), 1e-5f * length(total[i])) << bounces << ", " << i;
  }
}

TEST(CountBounces, IsAGeometricSeriesInASphere) {
  // Everything sees everything alike, so E is even and each bounce brings <rho> of the one before.
  const Room room = sphere(100);
  const Rgb sent = room.mean(room.sent), rho = room.mean(room.reflectance);
  for (const int bounces : {1, 2, 7})
    for (const Rgb& e : room.counted(bounces))
      for (int c = 0; c < 3; ++c) {
        const float want = sent[c] * (1 - std::pow(rho[c], float(bounces))) / (1 - rho[c]);
        EXPECT_NEAR(e[c], want, 1e-5f * want);  // sums of 100 floats
      }
}

TEST(AllBounces, AreTheSeriesLimitInASphere) {
  // E = <sent> / (1 - <rho>). Light is even, so clusters know its late bounces exactly: two sweeps
  // are enough whatever the clusters are.
  const Room room = sphere(300);
  const Rgb sent = room.mean(room.sent), rho = room.mean(room.reflectance);
  for (const size_t clusters : {1u, 8u, 100u})
    for (const Rgb& e : room.all(2, clusters))
      for (int c = 0; c < 3; ++c) {
        const float want = sent[c] / (1 - rho[c]);
        EXPECT_NEAR(e[c], want, 1e-5f * want);  // sums of 300 floats
      }
}

TEST(AllBounces, FurnaceIsExact) {
  // All emit e and reflect rho: E = B = e / (1 - rho), however light 0.95 would take to get there.
  Room room = sphere(200);
  const Rgb rho{0.2f, 0.5f, 0.95f};
  std::fill(room.reflectance.begin(), room.reflectance.end(), rho);
  std::fill(room.sent.begin(), room.sent.end(), Rgb{1, 2, 3});
  for (const Rgb& e : room.all(2, 16)) {
    EXPECT_NEAR(e.x, 1 / 0.8f, 2e-6);  // sums of 200 floats, near 1
    EXPECT_NEAR(e.y, 2 / 0.5f, 1e-5);
    EXPECT_NEAR(e.z, 3 / 0.05f, 6e-4);  // 1 - rho is known to 6e-8 / 0.05
  }
}

TEST(AllBounces, FurnaceBoxByItsRays) {
  const Cut cut(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}), 300);
  const Room room{cut.reciprocal_factors(512), cut.work.tree, cut.patches().area_m2,
                  cut.patches().elements.reflectance, cut.patches().emission};
  // Row sums are 1 within 1e-3 (see Reciprocal.KeepsRowSums), and 1 / (1 - rho) doubles that.
  for (const Rgb& e : room.all(3, 64)) EXPECT_NEAR(e.x, 2 * kPi, 2e-3 * double(2 * kPi));
}

TEST(AllBounces, EachSweepAtLeastHalvesTheError) {
  const Room room = cornell(400);
  // 0.7^200 = 1e-31 of the light is still to come.
  const std::vector<Rgb> limit = room.counted(200);
  for (const size_t clusters : {16u, 64u}) {
    double before = 1;
    for (int sweeps = 1; sweeps <= 6; ++sweeps) {
      const double error = testing::relative_error(room.all(sweeps, clusters), limit, room.area_m2);
      // Until what is left is rounding.
      EXPECT_LT(error, std::max(0.5 * before, 1e-6)) << clusters << " clusters, " << sweeps;
      before = error;
    }
  }
}

TEST(AllBounces, BeatBouncesThatAreCounted) {
  const Room room = cornell(400);
  const std::vector<Rgb> limit = room.counted(200);
  for (int products = 2; products <= 4; ++products)
    EXPECT_LT(testing::relative_error(room.all(products, 64), limit, room.area_m2),
              0.2 * testing::relative_error(room.counted(products), limit, room.area_m2));
}

TEST(AllBounces, OfBlackSurfacesAreTheFirst) {
  Room room = cornell(200);
  std::fill(room.reflectance.begin(), room.reflectance.end(), Rgb{});
  const std::vector<Rgb> first = testing::plain_product(room.factors, room.sent);
  for (int sweeps = 1; sweeps <= 3; ++sweeps) EXPECT_EQ(room.all(sweeps, 16), first);
  EXPECT_EQ(room.counted(4), first);
}

TEST(CoarseScene, KnowsClustersAndTheirAreas) {
  const Room room = cornell(400);
  const CoarseScene coarse =
      make_coarse_scene(room.factors, room.tree, room.area_m2, room.reflectance, 30);
  // The cut goes a whole depth at a time: fewer than twice as many as asked for.
  EXPECT_GE(coarse.count(), 30u);
  EXPECT_LT(coarse.count(), 60u);
  std::vector<double> area(coarse.count());
  for (size_t i = 0; i < room.area_m2.size(); ++i)
    area[coarse.cluster_of[i]] += double(room.area_m2[i]);
  // Sums of a dozen floats.
  for (size_t s = 0; s < area.size(); ++s) EXPECT_NEAR(area[s], coarse.area_m2[s], 1e-6 * area[s]);
  for (const auto& channel : coarse.response)
    EXPECT_EQ(channel.size(), coarse.count() * coarse.count());
}

/// Two spheres, patch by patch in turn: as near to each other as can be, and without any light
/// between them. One is white and alight, the other gray and dark.
Room two_spheres(size_t count) {
  Room room = sphere(count), half;
  for (size_t i = 0; i < count / 2; ++i) half.area_m2.push_back(room.area_m2[2 * i]);
  for (size_t i = 0; i < count / 2; ++i) room.area_m2[2 * i + 1] = room.area_m2[2 * i];
  const FormFactors one = testing::sphere_factors(half.area_m2);
  room.factors = {{0}, {}, {}};
  for (uint32_t i = 0; i < count; ++i) {
    for (uint32_t k = 0; k < count / 2; ++k) {
      room.factors.column.push_back(2 * k + i % 2);
      room.factors.factor.push_back(one.factors_of(i / 2)[k]);
    }
    room.factors.first.push_back(room.factors.column.size());
    room.sent[i] = i % 2 ? Rgb{} : Rgb{1, 2, 3};
    room.reflectance[i] = i % 2 ? Rgb{0.5f, 0.5f, 0.5f} : Rgb{0.9f, 0.8f, 0.2f};
  }
  return room;
}

TEST(AllBounces, NeverPassAClosedWall) {
  // E = e / (1 - rho) in the one after two sweeps, as ever in a sphere, and darkness in the other.
  const Room room = two_spheres(400);
  for (const size_t clusters : {1u, 16u, 64u}) {
    const std::vector<Rgb> e = room.all(2, clusters);
    for (size_t i = 0; i < e.size(); ++i)
      if (i % 2) {
        EXPECT_EQ(e[i], Rgb{}) << i;
      } else {
        EXPECT_NEAR(e[i].x, 1 / 0.1f, 1e-4f) << i;  // sums of 200 floats, 1 - rho to 6e-8 / 0.1
        EXPECT_NEAR(e[i].y, 2 / 0.2f, 1e-4f) << i;
        EXPECT_NEAR(e[i].z, 3 / 0.8f, 4e-5f) << i;
      }
  }
}

TEST(CoarseScene, APatchThatSeesNothingDoesNoHarm) {
  Room room = two_spheres(40);
  // Patch 6 lost its row and its column: both are empty, as of a patch that looks at the sky.
  FormFactors f{{0}, {}, {}};
  for (uint32_t i = 0; i < 40; ++i) {
    for (size_t k = 0; i != 6 && k < room.factors.columns_of(i).size(); ++k)
      if (room.factors.columns_of(i)[k] != 6) {
        f.column.push_back(room.factors.columns_of(i)[k]);
        f.factor.push_back(room.factors.factors_of(i)[k]);
      }
    f.first.push_back(f.column.size());
  }
  room.factors = f;
  const std::vector<Rgb> limit = room.counted(400), got = room.all(8, 4);
  EXPECT_EQ(got[6], Rgb{});
  // 0.9^400 = 5e-19 is still to come; a sweep at least halves what is missing, 2^-8 = 0.4 %.
  EXPECT_LT(testing::relative_error(got, limit, room.area_m2), 4e-3);
}

TEST(AllBounces, SameBitsForAnyNumberOfThreads) {
  const Room room = cornell(400);
  const auto light = [&](int threads) {
    const ThreadLimit limit(threads);
    return room.all(3, 128);
  };
  const std::vector<Rgb> one = light(1);
  EXPECT_EQ(one, light(2));
  EXPECT_EQ(one, light(7));
}

}  // namespace
}  // namespace luxel::matrix
