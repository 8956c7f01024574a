#include "luxel/pipeline/solver/plan.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/parallel.h"
#include "luxel/pipeline/solver/gather_light.h"
#include "luxel/pipeline/solver/solver_memory.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/solve/gather/forecast/forecast_rounds.h"

namespace luxel::pipeline {
namespace {

/// Of the texels, in a trial for a plan: a percent of the bake, but some thousand of them.
constexpr int kPlanPart = 100;
/// The same of the rounds to an error: of more texels, because some get many times the rays of
/// others.
constexpr int kRoundsPart = 16;
/// Measured on one core of an AMD EPYC; short beside the light of all bakes that are worth a plan.
constexpr double kDrawSeconds = 0.6, kSeamSecondsPerTexel = 4e-7, kWriteSecondsPerTexel = 4e-7;

}  // namespace

std::vector<Stage> stages_of(const gather::Forecast& forecast) {
  return {{"direct light", forecast.direct_s},
          {"supersample", forecast.supersample_s},
          {"trace rays", forecast.trace_s},
          {"bounces", forecast.bounces_s}};
}

std::vector<Stage> stages_after_solving(const SolveInput& in, const BakeSettings& settings) {
  const double threads = double(thread_count());
  const double square = double(in.map.resolution) * double(in.map.resolution);
  std::vector<Stage> stages{{"seams", kSeamSecondsPerTexel * double(in.elements.size())},
                            {"draw", kDrawSeconds / threads},
                            {"write files", kWriteSecondsPerTexel * square}};
  if (settings.html) stages.back().seconds *= 2;
  return stages;
}

Result<Plan> plan(const SolveInput& in, const BakeSettings& settings, Progress& progress) {
  if (settings.solver != "gather")
    return fail(ErrorCode::bad_setting,
                "--plan is for --solver gather; {} does not say what it will take",
                settings.solver);
  Plan out;
  out.resolution = in.map.resolution, out.texels = in.elements.size();
  progress.finish();
  out.stages = progress.stages();
  const double besides_hits = double(bytes_besides_hits(in, settings));
  LUXEL_TRY(const uint64_t hit_memory, memory_to_spare(in, settings, 0));
  gather::GatherParams params = gather_params(settings);
  LUXEL_TRY(const gather::Forecast forecast, gather::forecast(in, params, kPlanPart, progress));
  for (const Stage& stage : stages_of(forecast)) out.stages.push_back(stage);
  gather::RoundsForecast rounds;
  if (settings.max_error > 0) {
    LUXEL_TRY(rounds, gather::forecast_rounds(in, params, kRoundsPart, progress));
    out.stages.push_back({"rounds", rounds.trace_s + rounds.bounces_s});
  }
  for (const Stage& stage : stages_after_solving(in, settings)) out.stages.push_back(stage);
  for (const Stage& stage : out.stages) out.seconds += stage.seconds;
  if (settings.time_budget_s > 0) out.seconds = std::min(out.seconds, settings.time_budget_s);
  out.rays = forecast.rays + rounds.rays;
  const double hits = forecast.hit_bytes + rounds.hit_bytes;
  const double kept = std::min(hits, double(hit_memory));
  const double copy = gather::copy_bytes(hits, settings.max_error > 0 ? 0 : settings.samples);
  out.memory_bytes = besides_hits + std::min(kept + copy, double(hit_memory)),
  out.scratch_bytes = hits - kept;
  return out;
}

nlohmann::json to_json(const Plan& plan) {
  nlohmann::json seconds = stage_seconds(plan.stages);
  seconds["total"] = plan.seconds;  // with a time budget it ends before all stages are over
  return {{"resolution", plan.resolution},
          {"texels", plan.texels},
          {"rays", std::round(plan.rays)},
          {"seconds", seconds},
          {"memory_bytes", std::round(plan.memory_bytes)},
          {"scratch_bytes", std::round(plan.scratch_bytes)}};
}

}  // namespace luxel::pipeline
