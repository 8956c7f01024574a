// FLIP: the difference that a person sees who flips between two pictures. [Andersson20], and its
// extension to high dynamic range [Andersson21]. docs/method/compare.md has the equations.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/vec_double.h"
#include "luxel/image/compare.h"
#include "luxel/image/image.h"

namespace luxel::image {

struct FlipParams {
  /// Apparent size of pixels. The papers' observer sits 0.7 m from a screen that is 0.7 m and 3840
  /// pixels wide.
  double pixels_per_degree = 3840 * kPiDouble / 180;
  /// Advances by the rows, of each exposure. When it is cancelled the work ends early and the map
  /// is not to be used.
  Progress* progress = nullptr;
};

/// LDR-FLIP per pixel, one channel in [0, 1]. a and b are linear light with sRGB primaries (display
/// values decoded), of one size; values outside [0, 1] are clamped. Symmetric in a and b.
Image flip(const Image& a, const Image& b, const FlipParams& params = {});

/// The exposures of HDR-FLIP, as powers of two: `count` of them from start to stop.
struct FlipExposures {
  double start = 0, stop = 0;
  int count = 1;
};
/// From the reference: the brightest covered luminance, and then the median, comes out at 0.85 of
/// the tone mapper's range. A median of less than 2^-20 of the maximum counts as that.
/// When `progress` is cancelled the work ends early, with exposures of no meaning.
FlipExposures flip_exposures(const Image& reference, const Mask& covered,
                             const Progress* progress = nullptr);

/// HDR-FLIP per pixel: the largest LDR-FLIP over the exposures, each tone mapped by the papers'
/// filmic curve. a and b hold radiance or irradiance; negative values count as 0.
Image hdr_flip(const Image& a, const Image& b, const FlipExposures& exposures,
               const FlipParams& params = {});

/// `a` with the pixels of `b` where nothing is covered, so that what does not count differs by
/// nothing and bleeds over no edge.
Image with_uncovered_of(const Image& a, const Image& b, const Mask& covered);

}  // namespace luxel::image
