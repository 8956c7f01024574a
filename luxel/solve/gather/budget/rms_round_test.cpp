// Rounds that lower the root mean square error, and how much noise there is.
#include "luxel/solve/gather/budget/rms_round.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

// Variances of 4, 1 and 0 of gathered light, by 32 rays each, and of 1 of the third one's direct
// light, by 16 shadow rays, which cost as much as 8 rays. Doubling n leaves 2^-1.4 = 0.379 of a
// variance, four times the shadow rays leave 0.144. So a ray lowers the sum by 0.0776 in the first,
// by 0.0268 by shadow rays in the third, by 0.0194 in the second, and by 0.0147 in the first when
// it is doubled once more.
class RmsRoundOfThree : public testing::Test {
 protected:
  RoundPlan plan(double allowed, double affordable = INFINITY, int max_samples = 16384) const {
    return plan_rms_round({gathered_, direct_, samples_, levels_}, allowed, affordable,
                          ray_costs(1, 16, 64), max_samples);
  }
  std::vector<float> gathered_{4, 1, 0}, direct_{0, 0, 1};
  std::vector<uint16_t> samples_{32, 32, 32};
  light::DirectLevels levels_{std::vector<uint8_t>(3), std::vector<uint8_t>(3)};
};
using Counts = std::vector<uint16_t>;
using Flags = std::vector<uint8_t>;

TEST_F(RmsRoundOfThree, RaysGoWhereTheyLowerTheSumMost) {
  EXPECT_EQ(plan(6.1).samples, (Counts{32, 32, 32})) << "it is low enough";
  const RoundPlan first = plan(3.6);  // 6 - 4 (1 - 0.379) = 3.52
  EXPECT_EQ(first.samples, (Counts{64, 32, 32}));
  EXPECT_EQ(first.finer, (Flags{0, 0, 0}));
  const RoundPlan second = plan(2.7);  // 3.52 - 0.856 = 2.66
  EXPECT_EQ(second.samples, (Counts{64, 32, 32}));
  EXPECT_EQ(second.finer, (Flags{0, 0, 1}));
  EXPECT_EQ(plan(2.1).samples, (Counts{64, 64, 32})) << "2.66 - 0.621 = 2.04";
  EXPECT_EQ(plan(0).samples, (Counts{128, 128, 32})) << "no more than four times as many";
}

TEST_F(RmsRoundOfThree, NobodyGetsMoreThanThereIs) {
  EXPECT_EQ(plan(0, 40).samples, (Counts{64, 32, 32})) << "32 rays, and then 32 for direct light";
  EXPECT_EQ(plan(0, 20).samples, (Counts{32, 32, 32}));
  EXPECT_EQ(plan(0, INFINITY, 64).samples, (Counts{64, 64, 32}));
  levels_.level[2] = 4;  // as fine as it can be
  EXPECT_EQ(plan(0).finer, (Flags{0, 0, 0}));
}

// The judge: how much eight bakes with different random numbers differ, which nothing of the
// program's own estimates is part of. In an open scene under a bright sky stratified rays do far
// better than halves of them tell. About 1,000 texels and seven degrees of freedom know the truth
// to 1 %; some 512 texels that are lit twice know it to 3 to 5 %: 15 % are three standard errors.
TEST(NoiseByRepeating, IsWhatOtherSeedsDifferBy) {
  scene::Scene open = scene::cornell_box();
  open.background = {1, 1, 1};
  const auto room = lay_out(std::move(open), 32);
  GatherParams params{.samples = 64, .direct_samples = 16, .supersample = 16};
  constexpr int kSeeds = 8;
  std::vector<Gather> bakes;
  for (int k = 0; k < kSeeds; ++k) {
    params.seed = uint64_t(k) + 1;
    bakes.push_back(solve(*room, params));
  }
  double sum = 0, mean = 0, count = 0;
  for (size_t i = 0; i < room->elements.size(); ++i) {
    if (bakes[0].enclosed[i]) continue;
    double of_texel = 0, square = 0;
    for (const Gather& bake : bakes) of_texel += double(luminance(bake.irradiance[i])) / kSeeds;
    for (const Gather& bake : bakes)
      square += std::pow(double(luminance(bake.irradiance[i])) - of_texel, 2) / (kSeeds - 1);
    sum += square, mean += of_texel, count += 1;
  }
  const double truth = std::sqrt(sum * count) / mean;
  params.max_error = 1, params.error_measure = ErrorMeasure::rms;
  const Gather measured = solve(*room, params);
  EXPECT_NEAR(measured.relative_noise, truth, 0.15 * truth);
}

}  // namespace
}  // namespace luxel::gather
