// The summary that commands print of a finished bake.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "luxel/pipeline/settings/settings.h"

namespace luxel::cli {

/// Prints in words what bake.json holds, and the names of the files.
void print_bake(const pipeline::BakeSettings& settings, const nlohmann::json& json);

}  // namespace luxel::cli
