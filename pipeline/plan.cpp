#include "pipeline/plan.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "pipeline/gather_light.h"
#include "pipeline/solver_memory.h"
#include "pipeline/stage_seconds.h"
#include "solve/gather/adaptive.h"

namespace luxel::pipeline {
namespace {

/// Of the texels, in a trial for a plan: half a percent of the bake, but some thousand of them.
constexpr int kPlanPart = 200;
/// Measured on one core of an AMD EPYC; short beside the light of all bakes that are worth a plan.
constexpr double kDrawSeconds = 0.6, kSeamSecondsPerTexel = 4e-7, kWriteSecondsPerTexel = 4e-7;

struct Rounds {
  double seconds = 0, rays = 0, hit_bytes = 0;
};

/// What comes after the first round, which is made to know. How errors fall from there is a guess,
/// right within a factor of two or so. Errors: cancelled, disk full.
Result<Rounds> rounds_of(const SolveInput& in, const BakeSettings& settings,
                         const gather::Forecast& first, Progress& progress) {
  const gather::GatherParams params = gather_params(settings);
  gather::GatherParams once = params;
  once.max_error = 0;
  LUXEL_TRY(const gather::Gather result, gather::gather(in.scene, in.atlas, in.map, in.elements,
                                                        in.lights, in.tracer, once, progress));
  const double texels = double(in.elements.size()), before = texels * params.samples;
  const std::vector<uint64_t> added = gather::rounds_to_come(
      result.errors, result.gathered_errors, params.max_error, params.max_samples, result.samples);
  Rounds out;
  double samples = before;
  for (const uint64_t round : added) {
    samples += double(round);
    out.seconds += double(round) / before * first.trace_s + samples / before * first.bounces_s;
  }
  out.rays = (samples - before) / before * (first.rays - texels * params.direct_samples);
  // They go where it is dark: most of them meet something.
  out.hit_bytes = (samples - before) * double(sizeof(gather::StoredHit));
  return out;
}

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
  Rounds rounds;
  if (settings.max_error > 0) {
    LUXEL_TRY(rounds, rounds_of(in, settings, forecast, progress));
    out.stages.push_back({"rounds", rounds.seconds});
  }
  for (const Stage& stage : stages_after_solving(in, settings)) out.stages.push_back(stage);
  for (const Stage& stage : out.stages) out.seconds += stage.seconds;
  if (settings.time_budget_s > 0) out.seconds = std::min(out.seconds, settings.time_budget_s);
  out.rays = forecast.rays + rounds.rays;
  const double hits = forecast.hit_bytes + rounds.hit_bytes;
  const double kept = std::min(hits, double(hit_memory));
  out.memory_bytes = besides_hits + kept, out.scratch_bytes = hits - kept;
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
