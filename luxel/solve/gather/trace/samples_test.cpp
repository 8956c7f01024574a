// Gather's light for other numbers of samples and threads, other seeds and other stores of rays.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/rays/hit_store.h"

namespace luxel::gather {
namespace {

// Against 32 times the samples on the same map: stratified samples must at least keep up with
// independent ones, error ~ n^-1/2.
TEST(SlowGather, TheErrorFallsAtLeastWithTheRootOfTheSamples) {
  const auto room = lay_out(scene::cornell_box(), 48);
  GatherParams params = with_samples(8192, 1024);
  params.seed = 99;
  const Gather truth = solve(*room, params);
  std::vector<double> log_n, log_error;
  for (const int samples : {16, 64, 256}) {
    const Gather result = solve(*room, with_samples(samples, 1024));
    double sum2 = 0;
    for (size_t i = 0; i < truth.irradiance.size(); ++i) {
      const double d = double(luminance(result.irradiance[i]) - luminance(truth.irradiance[i]));
      sum2 += d * d;
    }
    log_n.push_back(std::log(double(samples)));
    log_error.push_back(0.5 * std::log(sum2 / double(truth.irradiance.size())));
  }
  // Least squares through the three points.
  double mx = 0, my = 0, sxy = 0, sxx = 0;
  for (size_t k = 0; k < 3; ++k) mx += log_n[k] / 3, my += log_error[k] / 3;
  for (size_t k = 0; k < 3; ++k) {
    sxy += (log_n[k] - mx) * (log_error[k] - my);
    sxx += (log_n[k] - mx) * (log_n[k] - mx);
  }
  EXPECT_LE(sxy / sxx, -0.5) << "errors " << std::exp(log_error[0]) << " .. "
                             << std::exp(log_error[2]);
}

uint64_t hash_of(std::span<const Rgb> values) {
  uint64_t h = 0;
  for (const Rgb& v : values)
    for (const float c : {v.x, v.y, v.z}) h = h * 0x100000001b3ull ^ std::bit_cast<uint32_t>(c);
  return h;
}

TEST(Gather, TheSameSeedGivesTheSameBitsForAnyNumberOfThreads) {
  const auto room = lay_out(scene::spheres_and_cube(), 96);
  std::vector<uint64_t> hashes;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    hashes.push_back(hash_of(solve(*room, with_samples(32, 8)).irradiance));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
  GatherParams other = with_samples(32, 8);
  other.seed = 2;
  EXPECT_NE(hashes[0], hash_of(solve(*room, other).irradiance));
}

// Tiles in the temporary file hold what tiles in memory hold.
TEST(Gather, TilesOnDiskGiveTheSameBits) {
  const auto room = lay_out(scene::cornell_box(), 96);
  const GatherParams params = with_samples(64, 8);
  GatherStores stores{.scratch_folder = ::testing::TempDir()};
  const Gather in_memory = solve(*room, params, stores);
  stores.hit_memory_bytes = 2 * kTileElements * 64 * sizeof(StoredHit);
  const Gather on_disk = solve(*room, params, stores);
  EXPECT_EQ(in_memory.hit_bytes_in_file, 0u);
  EXPECT_GT(on_disk.hit_bytes_in_file, 100000u);
  EXPECT_EQ(hash_of(in_memory.irradiance), hash_of(on_disk.irradiance));
}

// The true variance from 16 seeds, over some thousand texels. Halves of 32 samples are as
// stratified as the whole of 64: their estimate is larger than the truth by at most the gain of
// stratification from 32 to 64, less than a factor 3 even for smooth light, where twice the samples
// give an eighth of the variance instead of half of it, and never smaller, but for chance (a
// hundredth).
TEST(Gather, VarianceOfHalvesIsThatOfSeeds) {
  scene::Scene scene = scene::spheres_and_cube();
  const auto room = lay_out(std::move(scene), 64);
  constexpr int kSeeds = 16;
  const size_t n = room->elements.size();
  std::vector<double> sum(n), sum2(n);
  double stated = 0;
  for (int k = 0; k < kSeeds; ++k) {
    GatherParams params = with_samples(64, 4);
    params.seed = uint64_t(k + 1);
    const Gather result = solve(*room, params);
    for (size_t i = 0; i < n; ++i) {
      const double l = double(luminance(result.irradiance[i] - result.direct[i]));
      sum[i] += l, sum2[i] += l * l;
      stated += double(result.indirect_variance[i]) / kSeeds;
    }
  }
  double truth = 0;
  for (size_t i = 0; i < n; ++i) truth += (sum2[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
  EXPECT_GT(stated, 0.95 * truth);
  EXPECT_LT(stated, 3 * truth);
}

}  // namespace
}  // namespace luxel::gather
