#include "luxel/pipeline/solver/plan.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/parallel.h"
#include "luxel/pipeline/solver/stage_seconds.h"

namespace luxel::pipeline {
namespace {

/// Measured on one core of an AMD EPYC; short beside the light of all bakes that are worth a plan.
constexpr double kDrawSeconds = 0.3, kSeamSecondsPerTexel = 4e-7, kWriteSecondsPerTexel = 4e-7;
/// Measured on the same: docs/method/denoise.md.
constexpr double kDenoiseSecondsPerTexel = 1.3e-5;

}  // namespace

std::vector<Stage> stages_after_solving(const light::TexelScene& in, const BakeSettings& settings) {
  const double threads = double(thread_count());
  const double square = double(in.map.resolution) * double(in.map.resolution);
  std::vector<Stage> stages{{"seams", kSeamSecondsPerTexel * double(in.elements.size())},
                            {"draw", kDrawSeconds / threads},
                            {"write files", kWriteSecondsPerTexel * square}};
  if (settings.denoise)
    stages.insert(stages.begin(),
                  {"denoise", kDenoiseSecondsPerTexel * double(in.elements.size()) / threads});
  if (settings.html) stages.back().seconds *= 2;
  return stages;
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
