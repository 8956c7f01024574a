// The memory that the gather solver holds.
#pragma once

#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// The most that gather, and what is made of its light later, hold at a time [bytes], besides the
/// hits of rays and all that is there before. `shows`: somebody watches light grow. `layers` of
/// light are told apart.
uint64_t bytes_of_gather(const light::TexelScene& in, const BakeSettings& settings,
                         const SolveStores& stores, bool shows, size_t layers = 0);

}  // namespace luxel::pipeline
