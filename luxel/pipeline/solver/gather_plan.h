// The time and memory that gather's light will take.
#pragma once

#include "luxel/pipeline/solver/plan.h"
#include "luxel/solve/gather/forecast/forecast.h"

namespace luxel::pipeline {

/// By trials of a few texels. `progress` has the stages so far. Errors: cancelled; memory is too
/// small.
Result<Plan> plan_gather(const light::TexelScene& in, const BakeSettings& settings,
                         Progress& progress);

/// The stages of gather, and what they are expected to take.
std::vector<Stage> stages_of(const gather::Forecast& forecast, const BakeSettings& settings,
                             const BakeSize& size);
/// UsualFunction of gather.
std::vector<Stage> usual_gather(const BakeSettings& settings, double texels);

}  // namespace luxel::pipeline
