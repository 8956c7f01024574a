// Rays that follow a guide.
#include "luxel/solve/gather/budget/guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

// One cell has a deviation of 16 and all others 1. With variances that fall like n^-1.4, their
// counts are best as 16^(1 / 1.2) = 2^3.33 to 1. Level 2 has 128 rays at most: 16 in that cell and
// one in each other, 79 in all, for with two in the others there are 142. Level 3 has 181 at most:
// 32 and twice 63. Left of the variance at first: (63 + 256 * 16^-1.4) / (63 + 256) = 0.2140.
TEST(GuidedGroup, HasRaysInProportionToDeviations) {
  std::array<float, kCells> deviations;
  deviations.fill(0.5f);
  deviations[5] = 8;
  const GuidedGroup group = guided_group(deviations);
  const CellShares shares = shares_at(group, 1);
  for (size_t c = 0; c < kCells; ++c) EXPECT_EQ(shares.doublings[c], c == 5 ? 4 : 0);
  EXPECT_EQ(group.level(1).rays, 79);
  EXPECT_NEAR(group.level(1).left, (63 + 256 * std::exp2(-5.6)) / 319, 1e-5);
  EXPECT_EQ(group.level(2).rays, 79);
  EXPECT_EQ(group.level(3).rays, 32 + 2 * 63);
}

TEST(GuidedGroup, LevelsHaveNoMoreRaysThanTheirs) {
  std::array<float, kCells> deviations;
  for (size_t c = 0; c < kCells; ++c) deviations[c] = unit_float(uint32_t(hash64(9, c)));
  const GuidedGroup group = guided_group(deviations);
  for (int level = 1; level <= kGuideLevels; ++level) {
    EXPECT_LE(group.level(level).rays, 64.01f * std::exp2(0.5f * float(level)));
    EXPECT_GE(group.level(level).rays, 32 * std::exp2(0.5f * float(level)));
    EXPECT_EQ(shares_at(group, level).rays_per_sample() * 64, group.level(level).rays);
    if (level > 1) {
      EXPECT_LE(group.level(level).left, group.level(level - 1).left);
    }
  }
}

TEST(GuidedGroup, LeavesAllWhereNothingIsKnown) {
  std::array<float, kCells> deviations{};
  const GuidedGroup group = guided_group(deviations);
  for (int level = 1; level <= kGuideLevels; ++level) EXPECT_EQ(group.level(level).left, 1);
}

CellShares random_shares(uint64_t seed) {
  CellShares out;
  for (size_t c = 0; c < kCells; ++c) out.doublings[c] = uint8_t(hash64(seed, c) % 6);
  return out;
}

// The first 2^k / 64 of the samples' rays lie in each cell that has k doublings, and every round
// continues where the one before ended.
TEST(GuidedRays, AreTheFirstOfEachCell) {
  const CellShares shares = random_shares(3);
  RayBatch batch, equal;
  const Vec3 up{0, 0, 1};
  for (const Samples samples : {Samples{0, 64}, {64, 128}, {128, 512}}) {
    fill_rays({}, up, up, 7, samples, shares, batch);
    EXPECT_FLOAT_EQ(float(batch.rays.size()), float(samples.count()) * shares.rays_per_sample());
    for (size_t c = 0; c < kCells; ++c) {
      const Samples of_cell = samples.doubled(shares.doublings[c]);
      fill_rays({}, up, up, 7, of_cell, equal);
      ASSERT_EQ(batch.first_of_cell[c + 1] - batch.first_of_cell[c],
                equal.first_of_cell[c + 1] - equal.first_of_cell[c]);
      for (uint32_t k = batch.first_of_cell[c], j = equal.first_of_cell[c];
           k < batch.first_of_cell[c + 1]; ++k, ++j) {
        EXPECT_EQ(batch.sample[k], equal.sample[j]);
        EXPECT_EQ(batch.rays[k].direction, equal.rays[j].direction);
        EXPECT_EQ(batch.in_second_half(k, samples), 2 * batch.sample[k] >= of_cell.end);
      }
    }
  }
}

/// E that rays bring from a map, in rounds up to so many samples. `layers`: null: hits have none.
std::vector<Rgb> light_of(const Room& room, const RadiosityMap& sent, TracedHits& hits,
                          std::initializer_list<uint16_t> rounds,
                          const light::LightLayers* layers = nullptr) {
  Progress progress;
  const light::TexelScene in = scene_of(room);
  for (const uint16_t samples : rounds)
    EXPECT_TRUE(trace_more(trace_scene(in), std::vector<uint16_t>(hits.size(), samples),
                           {.seed = 5, .follows_near = true, .layers = layers}, hits, progress));
  std::vector<Rgb> e(hits.size());
  const std::vector<Rgb> none(hits.size());
  std::vector<float> variance(hits.size()), split(hits.size());
  Sweep sweep{.direct = none, .irradiance = e, .variance = variance, .split_variance = split};
  EXPECT_TRUE(run_sweep(sent, hits, sweep, progress));
  return e;
}

// Whatever the shares, the light is the same in the mean. The Cornell box without its front, under
// a bright sky: rays meet walls, escape, and are followed on from corners. Layers add up to what
// they bring.
TEST(GuidedRays, BringTheSameLight) {
  scene::Scene open = scene::cornell_box();
  open.background = {0.3f, 0.5f, 1};
  const auto room = lay_out(std::move(open), 32);
  const size_t n = room->elements.size();
  std::vector<Rgb> some(n);
  for (size_t i = 0; i < n; ++i) some[i] = Rgb{1, 1, 1} * float(i % 17);
  const auto layers = light::light_layers(room->scene, room->lights, light::LayerMode::per_light);
  ASSERT_TRUE(layers && layers->size() == 2);
  TracedHits equal = no_hits(n), guided = no_hits(n, 2);
  RadiosityMap sent = empty_radiosity_map(32);
  fill_radiosity(sent, room->map, room->elements, equal, {}, some);
  const std::vector<Rgb> a = light_of(*room, sent, equal, {512});
  light_of(*room, sent, guided, {32}, &*layers);
  for (uint64_t g = 0; g < 20; ++g) {
    std::array<float, kCells> deviations;
    for (size_t c = 0; c < kCells; ++c) deviations[c] = std::exp2(float(hash64(g, c) % 6));
    guided.guide.groups.push_back(guided_group(deviations));
  }
  for (uint32_t i = 0; i < n; ++i) guided.guide.of_element.push_back(i % 20);
  for (size_t i = 0; i < n; ++i) begin_guided(guided, i, 1 + int(i % kGuideLevels));
  const std::vector<Rgb> b = light_of(*room, sent, guided, {64, 128}, &*layers);
  double mean = 0, difference = 0, squares = 0;
  for (size_t i = 0; i < n; ++i) {
    const double d = double(luminance(b[i] - a[i]));
    mean += double(luminance(a[i])), difference += d, squares += d * d;
  }
  EXPECT_LT(std::abs(difference), 4 * std::sqrt(squares)) << "four standard errors";
  EXPECT_LT(std::sqrt(squares / double(n)), 0.05 * mean / double(n)) << "else that tells nothing";
  for (size_t i = 0; i < n; ++i) {
    const float all = luminance(guided.sky[i]);
    EXPECT_NEAR(luminance(guided.sky_by_layer[2 * i] + guided.sky_by_layer[2 * i + 1]), all,
                1e-5f * all);
  }
}

}  // namespace
}  // namespace luxel::gather
