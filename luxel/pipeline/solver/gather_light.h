// The gather solver, from a bake's settings: to a number of samples, to an error, or to a time.
#pragma once

#include "luxel/pipeline/solver/solvers.h"
#include "luxel/solve/gather/gather.h"

namespace luxel::pipeline {

Result<TexelLight> solve_gather(const SolveInput& in, const BakeSettings& settings,
                                Progress& progress);

/// What solve_gather asks for; with max_error or a time budget, of the first round.
gather::GatherParams gather_params(const BakeSettings& settings);

}  // namespace luxel::pipeline
