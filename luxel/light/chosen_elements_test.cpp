#include "luxel/light/chosen_elements.h"

#include <gtest/gtest.h>

namespace luxel::light {
namespace {

// Half of 1,000 elements are hidden, and three of the others are due nearly all noise. The weights
// of those that are chosen add up to 1, and what is as the noise has the mean that it has over all.
TEST(ChosenElements, StandForAll) {
  std::vector<float> noise(1000, 1e-3f);
  noise[500] = 5, noise[700] = 3, noise[999] = 1;
  const auto is_hidden = [](size_t i) { return i < 500; };
  const Chances chances = chances_of(noise, is_hidden);
  EXPECT_EQ(chances.count, 500);
  for (uint64_t seed = 1; seed < 5; ++seed) {
    const auto drawn = choose_elements(noise, is_hidden, chances, 100, seed);
    ASSERT_EQ(drawn.size(), 100u);
    const Answers chosen = answers_for(drawn, noise, chances);
    ASSERT_EQ(chosen.elements.size(), chosen.weight.size());
    double weights = 0, mean = 0;
    for (size_t k = 0; k < chosen.elements.size(); ++k) {
      EXPECT_GE(chosen.elements[k], 500u);
      weights += chosen.weight[k];
      mean += chosen.weight[k] * double(noise[chosen.elements[k]]);
    }
    EXPECT_NEAR(weights, 1, 0.05);
    EXPECT_NEAR(mean, 9.497 / 500, 0.05 * 9.497 / 500);
  }
}

// Light of 1 is off by 0.3 at one of five elements, whose weights are alike. At the others two
// answers err by 0.5, in all four ways: their noise drops out, where the square of either would be
// 0.25.
TEST(ChosenElements, LeaveTheNoiseOfTheirAnswersOut) {
  const Rgb one{1, 1, 1}, high = 1.5f * one, low = 0.5f * one;
  const Answers answers{.elements = {0, 1, 3, 4, 6},
                        .weight = std::vector<double>(5, 0.2),
                        .first = {high, one, high, low, low},
                        .second = {high, one, low, high, low}};
  std::vector<Rgb> light(7, one);
  light[1] = 1.3f * one;
  EXPECT_NEAR(square_error(answers, light).mean, 0.2 * 0.09, 1e-6);
}

}  // namespace
}  // namespace luxel::light
