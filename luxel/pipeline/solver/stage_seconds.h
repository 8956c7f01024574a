// The time that the stages of a command took, as its reports say it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "luxel/base/progress.h"

namespace luxel::pipeline {

/// Wall-clock seconds per stage, one entry for stages of the same name, and their `total`.
nlohmann::json stage_seconds(std::span<const Stage> stages);

/// Time that the stages leave of a --time-budget [s]: 0 or less where it is over, infinite where
/// there is no budget (0).
double seconds_left(double budget_s, std::span<const Stage> stages);

}  // namespace luxel::pipeline
