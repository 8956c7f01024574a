// Light probes of a bake, to be shown as balls.
#pragma once

#include <filesystem>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/light/light_around.h"

namespace luxel::view {

/// A ball at each probe; its surface shows E(n) by its normal n.
struct ProbeBalls {
  std::vector<light::Probe> probes;
  float spacing_m = 1;  ///< of their grid
};

/// So large is a ball [m].
inline float radius_of(const ProbeBalls& balls) { return 0.12f * balls.spacing_m; }

/// Reads probes.json and probes.exr of a bake of a scene with this origin. Errors: there are none,
/// and the sentence says how to make them; those of files; files that do not belong together.
Result<ProbeBalls> read_probes(const std::filesystem::path& folder, DVec3 origin);

}  // namespace luxel::view
