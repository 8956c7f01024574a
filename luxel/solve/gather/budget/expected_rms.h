// The root mean square error that a lightmap most likely has.
#pragma once

#include <cmath>
#include <span>

#include "luxel/base/vec.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {

/// Variances of each element's luminance, on the safe side [(W/m^2)^2].
struct SafeVariances {
  std::span<const float> noise;  ///< pooled_variances() of direct and gathered light
  std::span<const float> all;    ///< with TexelError::safe
  double likely_of_texels = 1;   ///< the likely square of what texels cost over the safe one
};

/// Mean square errors over the square of the mean luminance, of elements that no solid hides.
struct ExpectedSquares {
  double noise = 0, texels = 0;
  double shared_of_noise = 0;  ///< the part of the noise that bounces have carried to all elements

  double rms() const { return std::sqrt(noise + texels); }
  /// Light gathered anew from the same light has this error, too.
  double rms_of_gathered_light() const { return std::sqrt(shared_of_noise * noise + texels); }
};

/// The part of pooled_variances() that is to be expected, of all elements together.
inline constexpr double kOfNoise = 0.70710678;

/// The errors to expect. They are smaller than the variances say, which are bounds:
/// - Halves of n stratified samples tell the variance of n / 2, which is larger than twice that of
///   n. Along edges, where most of the noise is, it falls like n^-1.5: by sqrt(2) too large.
/// - TexelError::likely is smaller than TexelError::safe.
/// [Mitchell96, section 4] for n^-1.5 of stratified samples in two dimensions.
ExpectedSquares expected_squares(std::span<const Rgb> irradiance, const SafeVariances& variance,
                                 const TracedHits& hits);

}  // namespace luxel::gather
