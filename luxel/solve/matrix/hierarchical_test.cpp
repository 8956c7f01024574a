#include "luxel/solve/matrix/hierarchical.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

/// So many that no loss passes for noise.
constexpr int kNoNoise = 2'000'000'000;

Hierarchical compressed(const Cut& cut, const FormFactors& f, const HierarchicalParams& params) {
  Progress progress;
  auto out = compress(f, cut.patched.tree, cut.patches().centroid, cut.patches().area_m2, params,
                      progress);
  EXPECT_TRUE(out);
  return out ? std::move(*out) : Hierarchical{};
}

std::vector<Rgb> product(const Hierarchical& matrix, std::span<const Rgb> radiosity) {
  std::vector<Rgb> out(matrix.size());
  HierarchicalScratch scratch = make_scratch(matrix);
  multiply(matrix, radiosity, out, scratch);
  return out;
}

/// A scene with its factors, shared by tests.
struct ClusterBox {
  Cut cut{scene::cornell_box(), 1000};
  FormFactors factors = cut.reciprocal_factors(1024);
  std::span<const float> area_m2() const { return cut.patches().area_m2; }
};
const ClusterBox& cluster_box() {
  static const ClusterBox cluster_box;
  return cluster_box;
}

TEST(Hierarchical, IsExactToEightBitsWhereNothingMayBeLost) {
  const auto& [cut, f] = cluster_box();
  const Hierarchical h = compressed(cut, f, {0, kNoNoise});
  const std::vector<Rgb> b = testing::random_light(cut.size(), 1), got = product(h, b),
                         want = testing::plain_product(f, b);
  // An entry is off by its own rounding and what it carries on, half a step of 1/255 of the largest
  // entry of its pair of leaves each.
  std::vector<double> bound(cut.size(), 1e-6);
  for (const Cluster& r : cut.patched.tree.clusters)
    for (const Cluster& s : cut.patched.tree.clusters) {
      if (!r.is_leaf() || !s.is_leaf()) continue;
      float largest = 0;
      for (uint32_t i = r.first; i < r.end; ++i)
        for (size_t k = 0; k < f.columns_of(i).size(); ++k)
          if (const uint32_t j = f.columns_of(i)[k]; j >= s.first && j < s.end)
            largest = std::max(largest, f.factors_of(i)[k]);
      for (uint32_t i = r.first; i < r.end; ++i)
        for (uint32_t j = s.first; j < s.end; ++j)
          bound[i] += double(largest / 255 * max_component(b[j]));
    }
  for (size_t i = 0; i < cut.size(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[i][c], want[i][c], bound[i]) << i;
  // Errors of one row have either sign and mostly cancel.
  EXPECT_LT(testing::relative_error(got, want, cluster_box().area_m2()), 2e-3);
}

TEST(Hierarchical, IsNearlyThePlainProduct) {
  const std::vector<Rgb> b = testing::random_light(cluster_box().cut.size(), 2),
                         want = testing::plain_product(cluster_box().factors, b);
  const Hierarchical h = compressed(cluster_box().cut, cluster_box().factors, {0.003f, 1024});
  EXPECT_FALSE(h.far.empty());
  // Independent light per patch is the hardest there is: real light varies slowly.
  EXPECT_LT(testing::relative_error(product(h, b), want, cluster_box().area_m2()), 0.02);
}

/// Two clusters R and S at depth 6, each of 16 patches on a line of 2 m and one of hardly any area,
/// below a chain of clusters that split off a patch each.
ClusterTree lopsided_tree() {
  constexpr uint32_t kOfCluster = 17, kBoth = 2 * kOfCluster;
  ClusterTree tree;
  tree.clusters.push_back({0, kBoth + 5, 1, 0});
  for (uint32_t depth = 1; depth <= 5; ++depth) {
    const uint32_t end = kBoth + 5 - depth;
    tree.clusters.push_back({0, end, 2 * depth + 1, depth});
    tree.clusters.push_back({end, end + 1, 0, depth});
  }
  // R and S, the two parts of each, and the halves of their large parts.
  tree.clusters.push_back({0, kOfCluster, 13, 6});
  tree.clusters.push_back({kOfCluster, kBoth, 15, 6});
  for (const uint32_t first : {0u, kOfCluster}) {
    tree.clusters.push_back({first, first + 16, first == 0 ? 17u : 19u, 7});
    tree.clusters.push_back({first + 16, first + 17, 0, 7});
  }
  for (const uint32_t first : {0u, kOfCluster})
    for (const uint32_t half : {first, first + 8}) tree.clusters.push_back({half, half + 8, 0, 8});
  for (uint32_t i = 0; i < kBoth + 5; ++i) tree.order.push_back(i);
  return tree;
}

TEST(Hierarchical, ALopsidedHalfHidesNoExchange) {
  // One patch of R exchanges light with one of S. The larger parts of R and S see no more of that
  // than R and S do, their halves all of it.
  const ClusterTree tree = lopsided_tree();
  std::vector<Vec3> position;
  std::vector<float> area_m2;
  for (int i = 0; i < 39; ++i) {
    const int k = i % 17;
    position.push_back({0.125f * float(k), i < 17 ? 0.0f : 10.0f, 0});
    area_m2.push_back(k == 16 ? 1e-6f : 1.0f / 16);
  }
  FormFactors f;
  f.first.push_back(0);
  for (uint32_t i = 0; i < 39; ++i) {
    if (i == 0 || i == 17) f.column.push_back(17 - i), f.factor.push_back(0.1f);
    f.first.push_back(f.column.size());
  }
  Progress progress;
  const auto h = compress(f, tree, position, area_m2, {1e-3f, kNoNoise}, progress);
  ASSERT_TRUE(h);
  std::vector<Rgb> sent(39);
  sent[17] = {1, 1, 1};
  const std::vector<Rgb> got = product(*h, sent);
  EXPECT_NEAR(got[0].x, 0.1f, 1e-3f);  // 8 bits
  EXPECT_NEAR(got[1].x, 0, 1e-3f);
}

TEST(Hierarchical, LosesNoMoreThanRaysAreOff) {
  // The light of a lamp, which few rays of a patch meet; eight times as many know it better. What
  // blocks smooth over is to be noise: light is as near to the truth as before, within a fifth.
  const Cut cut(scene::cornell_box(), 500);
  const std::vector<Rgb>& lamp = cut.patches().emission;
  const std::vector<Rgb> truth = testing::plain_product(cut.reciprocal_factors(8192), lamp);
  const auto error = [&](std::span<const Rgb> e) {
    return testing::relative_error(e, truth, cut.patches().area_m2);
  };
  const FormFactors noisy = cut.reciprocal_factors(1024);
  EXPECT_LT(error(product(compressed(cut, noisy, {0.003f, 1024}), lamp)),
            1.2 * error(testing::plain_product(noisy, lamp)));
}

TEST(Hierarchical, ErrorAndSizeFallAndRiseWithBlockError) {
  const std::vector<Rgb> b = testing::random_light(cluster_box().cut.size(), 3),
                         want = testing::plain_product(cluster_box().factors, b);
  double error = 1;
  uint64_t bytes = 0;
  for (const float block_error : {0.1f, 0.03f, 0.01f, 0.003f}) {
    const Hierarchical h =
        compressed(cluster_box().cut, cluster_box().factors, {block_error, kNoNoise});
    const double now = testing::relative_error(product(h, b), want, cluster_box().area_m2());
    EXPECT_LT(now, error) << block_error;
    EXPECT_GT(bytes_of(h), bytes) << block_error;
    error = now, bytes = bytes_of(h);
  }
}

TEST(Hierarchical, StepByStepItIsWhatItIsAtOnce) {
  const auto& [cut, f] = cluster_box();
  Compression compression(f, cut.patched.tree, cut.patches().centroid, cut.patches().area_m2, 1024);
  // Large steps, one that divides nothing, and one after which leaves that were far are near.
  size_t far = 0, near = 0;
  for (const HierarchicalParams params : {HierarchicalParams{0.1f, 1024, 0.25f},
                                          {0.01f, 1024, 0.25f},
                                          {0.01f, 1024, 0.25f},
                                          {0.003f, 1024, 0.05f},
                                          {0, 1024, 0}}) {
    Progress progress;
    const auto got = compression.step(params, progress);
    ASSERT_TRUE(got);
    const Hierarchical want = compressed(cut, f, params);
    EXPECT_EQ(got->first_far, want.first_far);
    EXPECT_EQ(got->first_near, want.first_near);
    EXPECT_EQ(got->entries, want.entries);
    const std::vector<Rgb> b = testing::random_light(cut.size(), 11);
    EXPECT_EQ(product(*got, b), product(want, b)) << params.block_error;
    EXPECT_GE(got->near.size(), near);
    far = std::max(far, got->far.size()), near = got->near.size();
  }
  EXPECT_GT(far, 0u);
}

TEST(Hierarchical, KeepsThePowerOfConstants) {
  // 1 is a function of every cluster, so that far blocks keep sum A_i E_i; near ones keep rows.
  const std::vector<Rgb> one(cluster_box().cut.size(), Rgb{1, 0.5f, 2});
  for (const float block_error : {0.0f, 0.003f, 0.03f}) {
    const Hierarchical h =
        compressed(cluster_box().cut, cluster_box().factors, {block_error, 1024});
    const std::vector<Rgb> e = product(h, one);
    double got = 0, want = 0;
    for (size_t i = 0; i < e.size(); ++i) {
      const double a = double(cluster_box().area_m2()[i]);
      got += a * double(e[i].x), want += a * row_sum(cluster_box().factors, i);
      // Floats scaled by powers of two: channels do not mix.
      EXPECT_FLOAT_EQ(e[i].y * 2, e[i].x);
      EXPECT_FLOAT_EQ(e[i].z / 2, e[i].x);
    }
    // 16 bits of the largest coefficient, 8 of the largest entry.
    EXPECT_NEAR(got, want, 1e-3 * want) << block_error;
  }
}

TEST(Hierarchical, RowsOfConstantsAreRowSums) {
  const std::vector<Rgb> one(cluster_box().cut.size(), Rgb{1, 1, 1});
  const std::vector<Rgb> e =
      product(compressed(cluster_box().cut, cluster_box().factors, {0, kNoNoise}), one);
  // A row is carried to its end: half a step of the largest entry per pair of leaves is left, of
  // which there are some 150, of either sign.
  for (size_t i = 0; i < e.size(); ++i)
    EXPECT_NEAR(e[i].x, row_sum(cluster_box().factors, i), 5e-3) << i;
}

/// sum A_i (F b)_i c_i, per channel x.
double paired(const Hierarchical& h, std::span<const Rgb> b, std::span<const Rgb> c) {
  double sum = 0;
  const std::vector<Rgb> e = product(h, b);
  for (size_t i = 0; i < e.size(); ++i) sum += double(h.area_m2[i]) * double(e[i].x * c[i].x);
  return sum;
}

TEST(Hierarchical, IsItsOwnAdjoint) {
  // A_i F_ij = A_j F_ji: light from b that c weighs is light from c that b weighs. Light here and
  // weight there, so that it is not the whole's mean that agrees.
  std::vector<Rgb> b(cluster_box().cut.size()), c(b.size());
  RandomStream random{4};
  for (size_t i = 0; i < b.size(); ++i) {
    const Vec3 p = cluster_box().cut.patches().centroid[i];
    if (p.x < 0.2f) b[i].x = random.next();
    if (p.z > 0.3f) c[i].x = random.next();
  }
  for (const float block_error : {0.0f, 0.003f, 0.03f}) {
    const Hierarchical h =
        compressed(cluster_box().cut, cluster_box().factors, {block_error, 1024});
    // Far blocks are symmetric but for 16 bits; near ones are rounded to 8 bits on either side.
    EXPECT_NEAR(paired(h, b, c), paired(h, c, b), 1e-3 * paired(h, b, c)) << block_error;
  }
}

TEST(Hierarchical, IsLinear) {
  const std::vector<Rgb> b = testing::random_light(cluster_box().cut.size(), 5),
                         c = testing::random_light(cluster_box().cut.size(), 6);
  std::vector<Rgb> both(b.size());
  for (size_t i = 0; i < b.size(); ++i) both[i] = b[i] * 2 + c[i];
  const Hierarchical h = compressed(cluster_box().cut, cluster_box().factors, {});
  const std::vector<Rgb> eb = product(h, b), ec = product(h, c), e = product(h, both);
  for (size_t i = 0; i < e.size(); ++i)
    // Sums of a thousand floats, some of which cancel.
    EXPECT_LT(length(e[i] - (eb[i] * 2 + ec[i])), 1e-4f);
}

TEST(Hierarchical, LightIsNeverNegative) {
  // One bright patch: what smooth functions overshoot around it is cut off.
  const Hierarchical h = compressed(cluster_box().cut, cluster_box().factors, {0.1f, 64});
  for (size_t i = 0; i < h.size(); i += 37) {
    std::vector<Rgb> b(h.size());
    b[i] = {1000, 1000, 1000};
    for (const Rgb& e : product(h, b)) ASSERT_GE(min_component(e), 0);
  }
}

TEST(Hierarchical, AConstantKernelIsExactInBlocks) {
  // Inside a sphere F_ij = A_j / A: what arrives is the mean of what is sent.
  const Cut cut(scene::inward_sphere(1, 3, {0.5f, 0.5f, 0.5f}, {}), 400);
  const FormFactors f = testing::sphere_factors(cut.patches().area_m2);
  const Hierarchical h = compressed(cut, f, {1e-4f, kNoNoise});
  const std::vector<Rgb> b = testing::random_light(cut.size(), 7);
  double mean = 0;
  for (size_t i = 0; i < b.size(); ++i) mean += double(b[i].x * cut.patches().area_m2[i]);
  mean /= testing::sum_of(cut.patches().area_m2);
  EXPECT_FALSE(h.far.empty());
  EXPECT_LT(bytes_of(h), f.factor.size());  // a byte per entry would be all near
  // Near entries in 8 bits; far ones are one number per block.
  for (const Rgb& e : product(h, b)) EXPECT_NEAR(e.x, mean, 2e-3 * mean);
}

TEST(Hierarchical, PatchesAtOnePlaceAreNoTrouble) {
  const std::vector<Vec3> position(50, Vec3{1, 2, 3}), normal(50, Vec3{0, 1, 0});
  const std::vector<float> area(50, 2.0f);
  const FormFactors f = testing::sphere_factors(area);
  Progress progress;
  const auto h =
      compress(f, make_cluster_tree(position, normal, kLeafSize), position, area, {}, progress);
  ASSERT_TRUE(h);
  for (const Rgb& e : product(*h, std::vector<Rgb>(50, Rgb{1, 1, 1}))) EXPECT_NEAR(e.x, 1, 1e-3);
}

TEST(Hierarchical, ALeafKeepsItsRowsAndEntries) {
  // One leaf of eight patches: all near. 255 steps to the largest entry; what rounding takes from
  // one entry goes to the next, so that an entry is off by a step, a row by half a one.
  const size_t n = kLeafSize;
  const std::vector<float> area(n, 1.0f);
  const std::vector<Vec3> position = testing::random_light(n, 9), normal(n, Vec3{0, 1, 0});
  FormFactors f = testing::sphere_factors(area);
  const std::vector<Rgb> random = testing::random_light(n * n, 10);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j)
      f.factor[i * n + j] = random[std::min(i, j) * n + std::max(i, j)].x / float(n);
  Progress progress;
  const auto h = compress(f, make_cluster_tree(position, normal, kLeafSize), position, area,
                          {0, kNoNoise}, progress);
  ASSERT_TRUE(h);
  // 1 % for the floats' own rounding.
  const float step = 1.01f * *std::max_element(f.factor.begin(), f.factor.end()) / 255;
  const std::vector<Rgb> rows = product(*h, std::vector<Rgb>(n, Rgb{1, 1, 1}));
  for (uint32_t j = 0; j < n; ++j) {
    EXPECT_NEAR(rows[j].x, row_sum(f, j), step / 2);
    std::vector<Rgb> one(n);
    one[j] = {1, 0, 0};
    const std::vector<Rgb> column = product(*h, one);
    for (size_t i = 0; i < n; ++i) EXPECT_NEAR(column[i].x, f.factor[i * n + j], step);
  }
}

TEST(Hierarchical, AnEmptyMatrixSendsNothing) {
  const Cut cut(testing::plate(), 100);
  const Hierarchical h = compressed(cut, cut.reciprocal_factors(16), {});
  for (const Rgb& e : product(h, std::vector<Rgb>(cut.size(), Rgb{1, 1, 1}))) EXPECT_EQ(e, Rgb{});
}

TEST(Hierarchical, SameBitsForAnyNumberOfThreads) {
  const std::vector<Rgb> b = testing::random_light(cluster_box().cut.size(), 8);
  const auto light = [&](int threads) {
    const ThreadLimit limit(threads);
    return product(compressed(cluster_box().cut, cluster_box().factors, {}), b);
  };
  const std::vector<Rgb> one = light(1);
  EXPECT_EQ(one, light(2));
  EXPECT_EQ(one, light(7));
}

TEST(Hierarchical, CanBeCancelled) {
  Progress progress;
  progress.request_cancel();
  const auto h =
      compress(cluster_box().factors, cluster_box().cut.patched.tree,
               cluster_box().cut.patches().centroid, cluster_box().area_m2(), {}, progress);
  ASSERT_FALSE(h);
  EXPECT_EQ(h.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::matrix
