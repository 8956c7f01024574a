// The options of making an .lxr file, which the window has, too.
#pragma once

#include "luxel/pipeline/command/relight.h"
#include "luxel/pipeline/settings/option.h"

namespace luxel::pipeline {

/// --target, --resolution, --texels-per-metre, --uv, --patches, --rays, --codec, --max-error,
/// --bounces, --max-memory, --seed.
Options<RelightSettings> relight_options();

/// Those of them that change any bit of the file, by their keys.
nlohmann::json settings_of_lxr(const RelightSettings& settings);

}  // namespace luxel::pipeline
