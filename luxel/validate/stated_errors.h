// Whether the errors that solvers state are true.
#pragma once

#include <string_view>

#include "luxel/validate/agreement.h"

namespace luxel::validate {

/// One solution's stated error and its true one, by the judge.
struct StatedError {
  double stated = 0;  ///< TexelLight::relative_error
  /// Root mean square of the luminance's difference from the judge over the mean luminance, without
  /// the judge's noise.
  double truth = 0;
  double stated_p95 = 0;  ///< TexelLight::error_p95; 0: none is stated
  /// The 95th percentile of the texels' true errors, relative to themselves or a tenth of the mean.
  /// The judge's noise is in it.
  double true_p95 = 0;
  size_t texels = 0;
};
/// Over texels that neither hides. Light without texels or without light states nothing: zeros.
StatedError stated_error(const pipeline::TexelLight& light, const Judged& judged);

/// How often the truth lies within, over many solutions.
struct Held {
  int scenes = 0;
  int within = 0;           ///< the truth is no more than what is stated
  double middle_ratio = 0;  ///< median of truth / stated
  double p95_ratio = 0;     ///< its 95th percentile
};
/// Pairs with nothing stated are left out.
Held held(std::span<const double> stated, std::span<const double> truth);

}  // namespace luxel::validate
