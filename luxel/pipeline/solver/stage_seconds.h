// What the stages of a command took, as its reports say it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "luxel/base/progress.h"

namespace luxel::pipeline {

/// Wall-clock seconds per stage, one entry for stages of the same name, and their `total`.
nlohmann::json stage_seconds(std::span<const Stage> stages);

}  // namespace luxel::pipeline
