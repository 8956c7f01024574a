#include "luxel/pipeline/settings/quality.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace luxel::pipeline {
namespace {

BakeSettings set(Quality quality, const std::set<std::string, std::less<>>& given,
                 BakeSettings settings = {}) {
  set_quality(
      quality, [&](std::string_view flag) { return given.contains(flag); }, settings);
  return settings;
}

TEST(Quality, BetterMeansMore) {
  const QualityNumbers draft = numbers_of(Quality::draft), good = numbers_of(Quality::good),
                       best = numbers_of(Quality::best);
  EXPECT_LT(draft.samples, good.samples);
  EXPECT_LT(good.samples, best.samples);
  EXPECT_LT(draft.direct_samples, good.direct_samples);
  EXPECT_LT(good.direct_samples, best.direct_samples);
  EXPECT_LE(draft.supersample, good.supersample);
  EXPECT_LE(good.supersample, best.supersample);
  EXPECT_TRUE(draft.denoise && good.denoise);
  EXPECT_FALSE(best.denoise);
}

TEST(Quality, GivenNumbersWin) {
  BakeSettings mine;
  mine.direct_samples = 7;
  const BakeSettings s = set(Quality::good, {"--direct-samples"}, mine);
  EXPECT_EQ(s.quality, Quality::good);
  EXPECT_EQ(s.direct_samples, 7);
  EXPECT_EQ(s.samples, numbers_of(Quality::good).samples);
  EXPECT_TRUE(s.denoise);
  EXPECT_FALSE(set(Quality::good, {"--no-denoise"}).denoise);
}

/// 1024 rays: a quarter as many shadow rays, but at most 128, and a sixteenth as many points.
TEST(Quality, ShadowRaysAndPointsFollowGivenSamples) {
  BakeSettings asked;
  asked.samples = 1024;
  const BakeSettings s = set(Quality::good, {"--samples"}, asked);
  EXPECT_FALSE(s.direct_samples || s.supersample);
  EXPECT_EQ(first_direct_samples(s), 128);
  EXPECT_EQ(first_supersample(s), 64);
  asked.supersample = 5;
  EXPECT_EQ(set(Quality::good, {"--samples", "--supersample"}, asked).supersample, 5);
  asked.max_error = 0.02;  // samples are not looked at then
  EXPECT_EQ(set(Quality::good, {"--samples", "--max-error"}, asked).direct_samples,
            numbers_of(Quality::good).direct_samples);
}

/// A user who sets the amount of samples wants to see their light as it is.
TEST(Quality, LightOfGivenSamplesStaysAsItIs) {
  EXPECT_FALSE(set(Quality::good, {"--samples"}).denoise);
  BakeSettings asked;
  asked.max_error = 0.02;
  EXPECT_FALSE(set(Quality::draft, {"--max-error"}, asked).denoise);
}

TEST(Quality, LayersAreDenoisedAsAllLightIs) {
  BakeSettings layers;
  layers.layers = light::LayerMode::per_light;
  EXPECT_TRUE(set(Quality::good, {}, layers).denoise);
}

}  // namespace
}  // namespace luxel::pipeline
