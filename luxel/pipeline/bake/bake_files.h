// A bake's files in memory: lightmaps, baked.glb, preview.png, and what else was asked for.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "luxel/base/file.h"
#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// Everything but bake.json, under settings.output. Adds what bake.json says of them to `json`, an
/// object. Errors: a picture or page that does not fit its format; cancelled.
Result<std::vector<OutputFile>> files_of(const BakeSettings& settings, const Bake& bake,
                                         nlohmann::json& json, Progress& progress);

}  // namespace luxel::pipeline
