// Light that is still being worked out, for whoever watches.
#pragma once

#include <functional>
#include <span>

#include "luxel/base/vec.h"

namespace luxel::light {

/// E per element as far as it is known [W/m^2].
struct LightEstimate {
  std::span<const Rgb> irradiance;  ///< valid during the call
  std::span<const Rgb> direct;      ///< the part of it that comes straight from lights; likewise
  /// Rays per element in the mean; 0: none yet, what surfaces send each other is an ambient term.
  double samples = 0;
  float error_p95 = 0;   ///< 95 of 100 elements err by less, relative; 0: not known yet
  double error_rms = 0;  ///< root mean square error to expect over the mean; 0: not known yet
};

/// Called by the thread that called the solver, between its stages: the work goes on when it
/// returns.
using OnLightEstimate = std::function<void(const LightEstimate&)>;

}  // namespace luxel::light
