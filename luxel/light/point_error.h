// Error of the light at points that a solver reads from a mesh of its own.
#pragma once

#include <functional>
#include <span>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/chosen_elements.h"

namespace luxel::light {

/// A solver's light to check, and the scene that it is checked in.
struct PointCheck {
  const TexelScene& in;
  /// The solver's radiosity of the surface that a ray meets, without its emission [W/m^2].
  std::function<Rgb(const trace::Hit&)> radiosity;
  std::span<const float> noise;  ///< per element, what is believed of its luminance's variance
  SupersampleParams direct;      ///< as the light's
};

/// Two answers to E of some hundred elements that are not hidden: direct light with more shadow
/// rays, and rays that look at what surfaces send. Errors: cancelled.
Result<Answers> point_answers(const PointCheck& check, std::span<const uint8_t> hidden,
                              Progress& progress);

/// Root mean square error of E by such answers [W/m^2, luminance], at most two standard errors more
/// than was found. So this is the noise of direct light, and what the size of the solver's elements
/// costs near contacts and borders of light.
double point_error(const Answers& answers, std::span<const Rgb> irradiance);

}  // namespace luxel::light
