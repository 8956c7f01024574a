// Distance between two images. B is the reference everywhere.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/image.h"

namespace luxel::image {

/// One byte per pixel, row by row: 1 where it counts, 0 where it does not.
using Mask = std::vector<uint8_t>;

/// The pixels that both images cover: alpha is at least 1 in both (in a lightmap: a texel centre on
/// a surface), or all pixels of images without alpha. Errors: different sizes or channels, fewer
/// than three channels, the first value that is not finite, nothing covered in common. `name_a` and
/// `name_b` are the files named in errors.
Result<Mask> covered_pixels(const Image& a, std::string_view name_a, const Image& b,
                            std::string_view name_b);

/// Measures over the covered pixels p and the channels c = R, G, B, with d = a - b. A mean is one
/// over both. Formulas: docs/method/compare.md.
struct Difference {
  uint64_t texels = 0;          ///< covered pixels
  double mean = 0;              ///< mean of b
  double rmse = 0;              ///< root of the mean of d^2
  double rmse_over_mean = 0;    ///< rmse / |mean|
  double relative_rmse = 0;     ///< root of the mean of (d / (|b| + 0.01 |mean|))^2
  double mean_abs = 0;          ///< mean of |d|
  double max_abs = 0;           ///< largest |d|
  std::array<int, 2> max_at{};  ///< the first pixel (x, y) where it stands
  double bias = 0;              ///< mean of d
  double bias_over_mean = 0;    ///< bias / |mean|
  double peak = 0;              ///< largest value of b, what PSNR is measured against
  double psnr_db =
      0;  ///< 20 log10(peak / rmse); infinite for equal images, minus infinity for a black b
};

/// Measures over the mean of a black reference are infinite, or 0 when nothing differs. Sums are
/// taken in double, per row and then over the rows, so any number of threads gives the same bits.
/// a, b and the mask fit each other (covered_pixels says so). When `progress` is cancelled the work
/// ends early, with numbers of no meaning.
Difference difference(const Image& a, const Image& b, const Mask& covered,
                      const Progress* progress = nullptr);

/// covered_pixels and difference in one step.
Result<Difference> compare(const Image& a, std::string_view name_a, const Image& b,
                           std::string_view name_b);

/// Per pixel the relative error of `relative_rmse`: root of the mean over the channels; one
/// channel, 0 where nothing is covered.
Image relative_error_map(const Image& a, const Image& b, const Mask& covered, double mean);

/// Mean of a one-channel map over the covered pixels.
double mean_over(const Image& map, const Mask& covered);

/// The value below which the share `q` in [0, 1] of the covered pixels of a one-channel map lies.
double quantile_over(const Image& map, const Mask& covered, double q);

}  // namespace luxel::image
