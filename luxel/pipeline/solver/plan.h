// What a bake will take, before it is made.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "luxel/pipeline/solver/solvers.h"
#include "luxel/solve/gather/forecast/forecast.h"

namespace luxel::pipeline {

/// From trials of a few texels, all but what settings ask for besides the lightmap: probes.
struct Plan {
  int resolution = 0;
  size_t texels = 0;
  std::vector<Stage> stages;  ///< those before light, as they were, and those to come
  double seconds = 0, rays = 0;
  double memory_bytes = 0;   ///< the most the process will hold
  double scratch_bytes = 0;  ///< of temporary files
};

/// `progress` has the stages so far. Errors: cancelled; memory is too small; a solver other than
/// gather (bad_setting).
Result<Plan> plan(const SolveInput& in, const BakeSettings& settings, Progress& progress);

nlohmann::json to_json(const Plan& plan);

std::vector<Stage> stages_of(const gather::Forecast& forecast);
/// Seams, preview and files.
std::vector<Stage> stages_after_solving(const SolveInput& in, const BakeSettings& settings);

}  // namespace luxel::pipeline
