// Bakes to an error, judged by paths.
#include <gtest/gtest.h>

#include <cmath>

#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {
namespace {

BakeSettings box_at(int resolution) {
  BakeSettings settings;
  settings.scene = std::filesystem::path(LUXEL_SOURCE_DIR) / "scenes" / "cornell-box.glb";
  settings.output = std::filesystem::temp_directory_path();
  settings.resolution = resolution;
  settings.stitch = false;  // it moves light along seams, which the estimate does not know
  return settings;
}

Bake bake(const BakeSettings& settings) {
  Progress progress;
  Result<Bake> result = bake_scene(settings, progress);
  EXPECT_TRUE(result) << result.error().message;
  return std::move(*result);
}

// docs/guide/quality-and-time.md promises: the light of 9 texels of 10 and more differs from the
// truth by at most twice the claimed error and a thousandth of the mean. A path tracer knows the
// truth up to its own noise. Its paths know nothing of texels that stand for all of their area in
// later bounces: the claim includes that error of gather, too.
TEST(SlowMaxError, TheTruthLiesWithinTheClaim) {
  BakeSettings settings = box_at(64);
  settings.max_error = 0.02;
  const Bake claimed = bake(settings);
  settings.max_error = 0, settings.solver = "reference", settings.samples = 8192;
  const Bake truth = bake(settings);
  ASSERT_EQ(claimed.map.texels.size(), truth.map.texels.size());
  EXPECT_LE(claimed.light.error_p95, 0.02f);
  double mean = 0;
  for (const Rgb& e : truth.light.irradiance)
    mean += double(luminance(e)) / double(truth.light.irradiance.size());
  double judged = 0, within = 0;
  for (size_t i = 0; i < truth.light.irradiance.size(); ++i) {
    if (claimed.light.hidden[i] || truth.light.hidden[i]) continue;
    const double e = double(luminance(claimed.light.irradiance[i]));
    const double sigma = double(claimed.light.errors[i]) * std::max(e, 0.1 * mean);
    const double off = std::abs(e - double(luminance(truth.light.irradiance[i])));
    judged += 1;
    within += off <= 2 * std::sqrt(sigma * sigma + double(truth.light.variance[i])) + 0.001 * mean;
  }
  EXPECT_GT(within / judged, 0.9);
  EXPECT_GT(judged, 2000);
}

/// The time that was shown as left, each time that light was shown [s].
std::vector<double> seconds_left_while_lit(const BakeSettings& settings) {
  std::vector<double> out;
  Progress progress;
  BakeObserver observer;
  observer.on_estimate = [&](const light::TexelScene&, const light::LightEstimate&) {
    out.push_back(progress.snapshot().seconds_left);
  };
  const Result<Bake> result = bake_scene(settings, progress, {}, observer);
  EXPECT_TRUE(result) << result.error().message;
  return out;
}

// No trial is made for so little light: what most scenes take is shown.
TEST(TimeLeft, IsKnownWithoutATrial) {
  const std::vector<double> shown = seconds_left_while_lit(box_at(16));
  ASSERT_GE(shown.size(), 2u);
  for (const double left : shown) {
    EXPECT_GT(left, 0) << "files are still to be written";
    EXPECT_LT(left, 60);
  }
}

// The first estimates are shown before the first round's errors say how many are to come.
TEST(TimeLeft, ToAnErrorIsKnownAfterTheFirstRound) {
  BakeSettings settings = box_at(16);
  settings.max_error = 0.05;
  const std::vector<double> shown = seconds_left_while_lit(settings);
  ASSERT_GE(shown.size(), 4u);
  EXPECT_LT(shown.front(), 0);
  EXPECT_GT(shown.back(), 0) << "files are still to be written";
}

// All that the budget leaves is shown, not only the end's time. The test does not wait for it.
TEST(TimeLeft, IsThatOfABudget) {
  BakeSettings settings = box_at(32);
  settings.time_budget_s = 1000;
  Progress progress;
  double left = -1;
  BakeObserver observer;
  observer.on_estimate = [&](const light::TexelScene&, const light::LightEstimate&) {
    left = progress.snapshot().seconds_left;
    progress.request_cancel();
  };
  const Result<Bake> stopped = bake_scene(settings, progress, {}, observer);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
  EXPECT_LE(left, 1000);
  EXPECT_GT(left, 900) << "reading and direct light take a second";
}

// Each of two layers is denoised, stitched and written as the whole is: the share of the denoiser
// that finds neighbours is the only one that they have in common.
TEST(Plan, CountsLayersAfterTheLight) {
  BakeSettings settings = box_at(16);
  settings.denoise = true;
  const std::vector<Stage> one = stages_after_solving({1e6, 1e3, 100, 0}, settings),
                           three = stages_after_solving({1e6, 1e3, 100, 2}, settings);
  ASSERT_EQ(one.size(), three.size());
  for (size_t k = 0; k < one.size(); ++k) {
    const double times = three[k].seconds / one[k].seconds;
    const std::string& name = one[k].name;
    const bool is_once = name == "draw" || name == "neighbours", is_shared = name == "denoise";
    EXPECT_NEAR(times, is_once ? 1 : is_shared ? 2.5 : 3, 0.1) << name;
  }
}

TEST(Plan, IsForTheGatherSolver) {
  BakeSettings settings = box_at(16);
  settings.solver = "hemicube";
  Progress progress;
  const Result<Plan> none = plan_bake(settings, progress);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::bad_setting);
}

}  // namespace
}  // namespace luxel::pipeline
