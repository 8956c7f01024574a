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
  double samples = 0;    ///< rays per element in the mean; 0: none yet, there is a guess everywhere
  double share = 1;      ///< of elements that have their rays; the others have the guess
  float error_p95 = 0;   ///< 95 of 100 elements err by less, relative; 0: not known yet
  bool is_last = false;  ///< no light comes after it
  double error_rms = 0;  ///< root mean square error to expect over the mean; 0: not known yet
};

/// Called by one thread at a time, mostly by the one that called the solver, which goes on when it
/// returns. While rays are traced it is called by a thread that traces; the others go on.
using OnLightEstimate = std::function<void(const LightEstimate&)>;

/// Gets E per element [W/m^2], valid during the call, after no reflection, then after one, and so
/// on. True: the light of one reflection more is wanted.
using OnBounce = std::function<bool(std::span<const Rgb> irradiance)>;

}  // namespace luxel::light
