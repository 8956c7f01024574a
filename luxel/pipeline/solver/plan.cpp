#include "luxel/pipeline/solver/plan.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/machine_load.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/solver/solvers.h"
#include "luxel/pipeline/solver/stage_seconds.h"

namespace luxel::pipeline {
namespace {

// Measured on a core of an AMD EPYC, in five scenes of shared/scenes.

/// A view is chosen, and drawn.
constexpr double kDrawSeconds = 0.5, kDrawSecondsPerTriangle = 5e-5;
/// Walls that part neighbours are looked for.
constexpr double kPartSecondsPerTexel = 5e-7, kPartSecondsPerChart = 4e-5;
constexpr double kSeamSecondsPerTexel = 1e-7, kSeamSecondsPerChart = 3e-5;
constexpr double kWriteSecondsPerTexel = 4e-7;
/// Texels of small charts have neighbours on many others, which take long to find. A layer needs
/// this part of that time again.
constexpr double kDenoiseSecondsPerTexel = 1.05e-5, kDenoiseSecondsPerChart = 2e-4;
constexpr double kDenoiseOfLayer = 0.75;
/// Layout: one thread makes charts and packs them, all look for walls and move samples.
constexpr double kChartSecondsPerTriangle = 2e-6;
constexpr double kPackSeconds = 0.03, kPackSecondsPerTriangle = 2e-6;
constexpr double kWallSecondsPerTexel = 8e-7, kMoveSecondsPerTexel = 2e-6;
/// The part of the square that charts cover, and triangles per chart.
constexpr double kCovered = 0.7, kTrianglesPerChart = 4;

}  // namespace

BakeSize bake_size(const light::TexelScene& in, const BakeSettings& settings) {
  BakeSize out{.texels = double(in.elements.size()),
               .side = double(in.map.resolution),
               .charts = double(in.atlas.chart_count),
               .triangles = double(in.atlas.corners.size())};
  if (settings.layers != light::LayerMode::none)
    if (const auto layers = light::light_layers(in.scene, in.lights, settings.layers))
      out.layers = double(layers->size());
  return out;
}

std::vector<Stage> stages_after_solving(const BakeSize& size, const BakeSettings& settings) {
  const double threads = double(thread_count());
  std::vector<Stage> stages;
  if (settings.repair_leaks)
    stages.push_back(
        {"neighbours",
         (kPartSecondsPerTexel * size.texels + kPartSecondsPerChart * size.charts) / threads});
  if (settings.denoise)
    stages.push_back({"denoise", (kDenoiseSecondsPerTexel * size.texels +
                                  kDenoiseSecondsPerChart * size.charts) *
                                     (1 + kDenoiseOfLayer * size.layers) / threads});
  stages.push_back({"seams", (1 + size.layers) * (kSeamSecondsPerTexel * size.texels +
                                                  kSeamSecondsPerChart * size.charts)});
  stages.push_back({"draw", (kDrawSeconds + kDrawSecondsPerTriangle * size.triangles) / threads});
  stages.push_back(
      {"write files", (1 + size.layers) * kWriteSecondsPerTexel * size.side * size.side});
  if (settings.html) stages.back().seconds *= 2;
  const double load = machine_load();
  for (Stage& stage : stages) stage.seconds *= load;
  return stages;
}

void expect_usual_bake(const scene::Scene& scene, const BakeSettings& settings,
                       Progress& progress) {
  if (!settings.resolution || settings.pages.mode != atlas::PageMode::fixed) return;
  const double side = *settings.resolution;
  const double triangles = double(scene::first_triangles(scene).back());
  const BakeSize size{.texels = kCovered * side * side * settings.pages.count,
                      .side = side,
                      .charts = triangles / kTrianglesPerChart,
                      .triangles = triangles};
  const std::vector<Stage> after = stages_after_solving(size, settings);
  progress.expect_at_end(after);
  if (settings.time_budget_s > 0)
    return progress.expect_within(
        std::max(0.0, seconds_left(settings.time_budget_s, progress.stages()) - seconds_of(after)));
  const Solver& solver = *find_solver(settings.solver);
  const std::vector<Stage> light =
      solver.usual ? solver.usual(settings, size.texels) : std::vector<Stage>{};
  if (light.empty()) return;
  const double threads = double(thread_count());
  std::vector<Stage> stages{
      {"charts", kChartSecondsPerTriangle * triangles},
      {"sides", 0},
      {"packing", kPackSeconds + kPackSecondsPerTriangle * triangles},
      {"walls", kWallSecondsPerTexel * size.texels / threads},
      {"samples", kMoveSecondsPerTexel * size.texels / threads},
  };
  for (const Stage& stage : light) stages.push_back({stage.name, stage.seconds / threads});
  const double load = machine_load();
  for (Stage& stage : stages) stage.seconds *= load;
  progress.expect(std::move(stages));
}

double seconds_of(std::span<const Stage> stages) {
  double sum = 0;
  for (const Stage& stage : stages) sum += stage.seconds;
  return sum;
}

nlohmann::json to_json(const Plan& plan) {
  nlohmann::json seconds = stage_seconds(plan.stages);
  seconds["total"] = plan.seconds;  // with a time budget it ends before all stages are over
  return {{"resolution", plan.resolution},
          {"texels", plan.texels},
          {"rays", uint64_t(std::round(plan.rays))},
          {"seconds", seconds},
          {"memory_bytes", uint64_t(std::round(plan.memory_bytes))},
          {"scratch_bytes", uint64_t(std::round(plan.scratch_bytes))}};
}

}  // namespace luxel::pipeline
