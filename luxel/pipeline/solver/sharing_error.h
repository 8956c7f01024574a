// The error of texels that charts of a kept TEXCOORD_1 share.
#pragma once

#include "luxel/pipeline/solver/measured_error.h"

namespace luxel::pipeline {

/// Root mean square error of the luminance of E over its mean that texels have on the parts which
/// triangles of other charts than their own cover (atlas::shared_parts), each counted by its part
/// of the texel; 0 without such parts. Solvers do not know it: they compute the light of the chart
/// that owns a texel. Paths from the middles of some hundred parts give two answers, and their
/// noise drops out (measured_error). Parts inside of solids do not count. The stage "check".
/// Errors: cancelled.
Result<double> sharing_error(const light::TexelScene& in, const TexelLight& light,
                             const CheckParams& params, Progress& progress);

}  // namespace luxel::pipeline
