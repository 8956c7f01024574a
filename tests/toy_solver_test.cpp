// The sixth solver, of ARCHITECTURE.md's diff, linked in front of the table that luxel has.
#include <gtest/gtest.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/solve/device/relight_shared.h"
#include "luxel/validate/agreement.h"

namespace luxel::validate {
namespace {

double mean_luminance(const pipeline::TexelLight& light) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i)
    if (!light.hidden[i]) sum += luminance(light.irradiance[i]), ++count;
  return sum / count;
}

TEST(ToySolver, HasItsOptionEverywhere) {
  const pipeline::Solver* paths = pipeline::find_solver("paths");
  ASSERT_NE(paths, nullptr);
  EXPECT_EQ(pipeline::solvers_with("--paths"), "paths");
  pipeline::BakeSettings settings;
  settings.scene = "box.glb", settings.solver = "paths";
  const auto row = pipeline::option_of(*paths, "--paths");
  ASSERT_TRUE(row);
  EXPECT_FALSE((*row)->read_text(settings, "0"));
  ASSERT_TRUE((*row)->read_text(settings, "32"));
  EXPECT_TRUE(pipeline::check(settings));
  EXPECT_EQ(pipeline::to_json(settings)["paths"]["paths"], 32);
  pipeline::BakeSettings other = settings;
  ASSERT_TRUE((*row)->read_text(other, "33"));
  EXPECT_NE(pipeline::settings_of_checkpoint(other), pipeline::settings_of_checkpoint(settings));
}

// 64 paths at some 600 texels of the lamp's room: their mean is known to 0.4 %, and a texel's
// middle is not its mean where shadows have edges. Four standard errors.
TEST(ToySolver, AgreesWithGather) {
  Progress progress;
  std::vector<AgreementScene> scenes = agreement_scenes();
  const auto lamp = std::find_if(scenes.begin(), scenes.end(), [](const AgreementScene& s) {
    return s.name == "point light in a room";
  });
  ASSERT_NE(lamp, scenes.end());
  const auto p = prepare(std::move(lamp->scene), 32, progress);
  ASSERT_TRUE(p);
  const auto paths = solve(**p, "paths", {}, progress), gather = solve(**p, "gather", {}, progress);
  ASSERT_TRUE(paths && gather);
  EXPECT_NEAR(mean_luminance(paths->light) / mean_luminance(gather->light), 1, 0.016);
}

// The diff's new member of a buffer: this is the copy that has it.
TEST(ToyMember, FollowsTheOneBefore) {
  using on_device::RelightSetup;
  EXPECT_EQ(offsetof(RelightSetup, darkest), offsetof(RelightSetup, kept_unit) + sizeof(Rgb));
}

}  // namespace
}  // namespace luxel::validate
