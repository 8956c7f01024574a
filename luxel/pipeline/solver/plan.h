// What a bake will take, before it is made.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/light/texel_scene.h"
#include "luxel/pipeline/settings/settings.h"

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

/// The object of `luxel bake --plan --json`.
nlohmann::json to_json(const Plan& plan);

/// Seams, preview and files, with what they are expected to take.
std::vector<Stage> stages_after_solving(const light::TexelScene& in, const BakeSettings& settings);

}  // namespace luxel::pipeline
