#include "luxel/validate/stated_errors.h"

#include <gtest/gtest.h>

#include "luxel/validate/random_scenes.h"

namespace luxel::validate {
namespace {

TEST(StatedErrors, RandomScenesAreDecidedByTheirSeed) {
  const RandomScene first = random_scene(3), again = random_scene(3), other = random_scene(4);
  EXPECT_EQ(first.lamp, again.lamp);
  ASSERT_EQ(first.scene.meshes.size(), again.scene.meshes.size());
  for (size_t m = 0; m < first.scene.meshes.size(); ++m)
    EXPECT_EQ(first.scene.meshes[m].positions, again.scene.meshes[m].positions);
  EXPECT_NE(first.scene.meshes[0].positions, other.scene.meshes[0].positions);
}

// Two texels of light 1, off by 0.1 and -0.3. The judge errs by 0.2 to either side.
TEST(StatedErrors, TheJudgesNoiseDropsOut) {
  Judged judged;
  judged.first = {Rgb{1.2f, 1.2f, 1.2f}, Rgb{0.8f, 0.8f, 0.8f}};
  judged.second = {Rgb{0.8f, 0.8f, 0.8f}, Rgb{1.2f, 1.2f, 1.2f}};
  judged.hidden = {0, 0};
  pipeline::TexelLight light;
  light.irradiance = {Rgb{1.1f, 1.1f, 1.1f}, Rgb{0.7f, 0.7f, 0.7f}};
  light.relative_error = 0.2;
  const StatedError e = stated_error(light, judged);
  // The mean of (1.1 - 1.2)(1.1 - 0.8) and (0.7 - 0.8)(0.7 - 1.2) is 0.01.
  EXPECT_NEAR(e.truth, 0.1, 1e-6);
  EXPECT_EQ(e.texels, 2u);
}

TEST(StatedErrors, CountsWhatHolds) {
  const std::vector<double> stated{1, 1, 2, 0}, truth{0.5, 2, 1, 7};
  const Held h = held(stated, truth);
  EXPECT_EQ(h.scenes, 3);
  EXPECT_EQ(h.within, 2);
  EXPECT_EQ(h.middle_ratio, 0.5);
}

}  // namespace
}  // namespace luxel::validate
