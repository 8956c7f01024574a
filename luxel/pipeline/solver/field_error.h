// How far the texels of a solver with a mesh of its own are off.
#pragma once

#include <functional>

#include "luxel/base/progress.h"
#include "luxel/light/direct_light.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// A solver's light between its elements.
struct SolvedField {
  std::function<Rgb(const scene::SurfacePoint&)> irradiance_at;  ///< E of a surface [W/m^2]
  float cover_size_m = 0;  ///< by which places are covered (transport::open_share)
};

/// Rays from some hundred texels look at the solver's light, and direct light is exact but for its
/// visible share: root mean square difference from the texels' light, over its mean; at most one
/// standard error more than was found (light::point_error). Covered texels do not count: what they
/// see is covered as well, and the field has no light of its own there. Errors: cancelled.
Result<double> field_error(const light::TexelScene& in, const TexelLight& light,
                           const SolvedField& field, const light::DirectParams& direct,
                           Progress& progress);

}  // namespace luxel::pipeline
