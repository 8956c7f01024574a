// How far the texels of a solver with a mesh of its own are off.
#pragma once

#include <functional>

#include "luxel/base/progress.h"
#include "luxel/light/direct_light.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// The solver's E at a point of a surface [W/m^2].
using IrradianceAt = std::function<Rgb(const scene::SurfacePoint&)>;

/// Rays from some hundred texels look at the solver's light, and direct light is exact but for its
/// visible share: root mean square difference from the texels' light, over its mean; at most one
/// standard error more than was found (light::point_error). Errors: cancelled.
Result<double> field_error(const light::TexelScene& in, const TexelLight& light,
                           const IrradianceAt& irradiance_at, const light::DirectParams& direct,
                           Progress& progress);

}  // namespace luxel::pipeline
