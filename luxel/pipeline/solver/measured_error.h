// Measures by paths how far the texels of a solver are off.
#pragma once

#include <cmath>
#include <cstdint>

#include "luxel/base/progress.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

struct CheckParams {
  int bounces = -1;  ///< that the light has; < 0: all
  uint64_t seed = 1;
  double seconds = INFINITY;  ///< more paths are begun only where they end within this
};

/// About what measured_error() takes one core in most scenes [s].
inline constexpr double kMeasuredErrorSeconds = 1.5;
/// Root mean square error of the luminance of E over its mean, over the texels that are not hidden,
/// at most by upper_mean(). Paths of all bounces [reference/path_tracer.h] from some hundred texels
/// give two independent answers a and b at each. For light g the mean of (g - a)(g - b) is that of
/// the square of g's error: the noise of the paths drops out. Rays that look at the solver's own
/// light once would miss most of what bright rooms get too little of: light that is too dark by a
/// part e everywhere shows them a difference of e (1 - rho) alone. Paths are added, at more texels
/// or up to some hundred per texel, until the answer is known to a fifth of itself. Errors:
/// cancelled.
Result<double> measured_error(const light::TexelScene& in, const TexelLight& light,
                              const CheckParams& params, Progress& progress);

}  // namespace luxel::pipeline
