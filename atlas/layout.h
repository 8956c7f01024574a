// The largest density at which all charts fit a square, or the smallest square for a density.
#pragma once

#include <vector>

#include "atlas/pack.h"
#include "atlas/project.h"
#include "base/progress.h"
#include "base/result.h"

namespace luxel::atlas {

struct Layout {
  int resolution = 0;
  double texels_per_metre = 0;
  std::vector<std::vector<std::array<DVec2, 3>>>
      local;  ///< per chart, per face: texels from its place
  std::vector<std::vector<std::array<DVec2, 3>>> texels;  ///< the same on the atlas
};

/// Corners of a chart in texels: scaled, slivers shortened, on the fixed-point grid.
std::vector<std::array<DVec2, 3>> texel_corners(const FlatChart& chart, double texels_per_metre,
                                                int resolution);

/// Whether a square has room for as many charts when each shrinks to a single texel.
bool holds_charts(int resolution, size_t charts, int gutter);

/// first_guess > 0 is a density known to be nearly as large as can be: taken when it fits.
/// Error (bad_setting): the square does not hold the charts.
Result<Layout> layout_in_square(const std::vector<FlatChart>& charts, int resolution, int gutter,
                                double first_guess, Progress& progress);
/// Error: not even the largest square is enough.
Result<Layout> layout_at_density(const std::vector<FlatChart>& charts, double texels_per_metre,
                                 int gutter, Progress& progress);

inline constexpr int kMaxResolution = 16384;

}  // namespace luxel::atlas
