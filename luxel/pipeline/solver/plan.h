// The time and memory that a bake will take, before it is made.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
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

/// The sizes from which the time of stages beside light follows.
struct BakeSize {
  double texels = 0, side = 0;  ///< side of the square
  double charts = 0;
  double layers = 0;  ///< that light is told apart into
  double triangles = 0;
};
BakeSize bake_size(const light::TexelScene& in, const BakeSettings& settings);

/// Neighbours that walls part, denoiser, seams, preview and files, with what they are expected to
/// take on a machine that is as busy as it is.
std::vector<Stage> stages_after_solving(const BakeSize& size, const BakeSettings& settings);

double seconds_of(std::span<const Stage> stages);

/// Tells `progress` what a bake takes of a scene that is not laid out yet: its time budget, or what
/// texels and triangles take of most scenes, which the speed of each stage corrects.
void expect_usual_bake(const scene::Scene& scene, const BakeSettings& settings, Progress& progress);

}  // namespace luxel::pipeline
