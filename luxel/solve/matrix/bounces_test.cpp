#include "luxel/solve/matrix/bounces.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

Multiply plain(const FormFactors& f) {
  return [&f](std::span<const Rgb> b, std::span<Rgb> e) { testing::plain_product(f, b, e); };
}

/// Data that bounces are made of.
struct Room {
  FormFactors factors;
  ClusterTree tree;
  std::vector<float> area_m2;
  std::vector<Rgb> reflectance, sent;

  std::vector<Rgb> counted(int bounces) const {
    std::vector<Rgb> out(sent.size());
    BounceScratch scratch = make_bounce_scratch(sent.size(), 0);
    count_bounces(plain(factors), {sent, reflectance, area_m2, bounces}, out, scratch);
    return out;
  }
  std::vector<Rgb> all(int sweeps, size_t clusters) const {
    const CoarseScene coarse = make_coarse_scene(factors, tree, area_m2, reflectance, clusters);
    std::vector<Rgb> out(sent.size());
    BounceScratch scratch = make_bounce_scratch(sent.size(), coarse.count());
    all_bounces(plain(factors), coarse, {sent, reflectance, area_m2}, sweeps, out, scratch);
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
  return {cut.reciprocal_factors(1024), cut.patched.tree, cut.patches().area_m2,
          copied(cut.patches().elements.reflectance), cut.patches().emission};
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
    // Equal sums in another order.
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
  const Room room{cut.reciprocal_factors(512), cut.patched.tree, cut.patches().area_m2,
                  copied(cut.patches().elements.reflectance), cut.patches().emission};
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

/// A room with a lamp, and in it a closed box whose sides are patches inside, too.
Room box_in_a_room(size_t count) {
  scene::Scene scene = scene::furnace_box({0.7f, 0.5f, 0.3f}, {});
  const uint32_t card = scene::add_material(scene, "card", {0.6f, 0.6f, 0.6f});
  const uint32_t lamp = scene::add_material(scene, "lamp", {}, {1, 1, 1});
  scene.materials[card].double_sided = true;
  scene::add_rectangle(scene, {0.1f, 0.3f, 0.1f, 0.3f}, 0.95f, false, lamp);
  scene::Mesh box;
  scene::add_box(box, {0.4f, 0.2f, 0.4f}, {0.8f, 0.6f, 0.8f}, card);
  scene::place(scene, std::move(box));
  const Cut cut(std::move(scene), count);
  return {cut.reciprocal_factors(512), cut.patched.tree, cut.patches().area_m2,
          copied(cut.patches().elements.reflectance), cut.patches().emission};
}

TEST(AllBounces, HardlyPassAClosedWall) {
  const Room room = box_in_a_room(1000);
  // 0.7^100 = 3e-16 of the light is still to come.
  const std::vector<Rgb> limit = room.counted(100);
  size_t dark = 0;
  for (const Rgb& e : limit)
    dark += max_component(e) < 1e-5f;  // a ray or two slip in where sides meet
  EXPECT_GT(dark, 50u);                // 6 x 0.4^2 of 8.9 m^2 are inside
  double before = 1;
  for (int sweeps = 1; sweeps <= 6; ++sweeps) {
    // With as many clusters as relighting asks for. As without the box: what clusters let through
    // its walls is soon found to be wrong.
    const double error = testing::relative_error(room.all(sweeps, 300), limit, room.area_m2);
    EXPECT_LT(error, std::max(0.5 * before, 1e-6)) << sweeps;
    before = error;
  }
}

TEST(CoarseScene, PatchesThatSeeNothingDoNoHarm) {
  // The sixth patch looks at the sky: its row and its column are empty.
  Room room = sphere(200);
  FormFactors f{{0}, {}, {}};
  for (uint32_t i = 0; i < 200; ++i) {
    for (size_t k = 0; i != 6 && k < 200; ++k)
      if (k != 6)
        f.column.push_back(uint32_t(k)), f.factor.push_back(room.factors.factors_of(i)[k]);
    f.first.push_back(f.column.size());
  }
  room.factors = f;
  const std::vector<Rgb> limit = room.counted(400), got = room.all(8, 16);
  EXPECT_EQ(got[6], Rgb{});
  // A sweep at least halves what is missing: 2^-8 = 0.4 %.
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
