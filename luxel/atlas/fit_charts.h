// The largest density at which all charts fit a square or several, or the smallest square or the
// fewest squares for a density.
#pragma once

#include <vector>

#include "luxel/atlas/pack.h"
#include "luxel/atlas/pages.h"
#include "luxel/atlas/project.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel::atlas {

struct Layout {
  int resolution = 0;  ///< of the whole atlas
  double texels_per_metre = 0;
  std::vector<std::vector<std::array<DVec2, 3>>>
      local;  ///< per chart, per face: texels from its place
  std::vector<std::vector<std::array<DVec2, 3>>> texels;  ///< the same on the atlas
  std::vector<Page> pages;                                ///< at least one
  std::vector<uint32_t> page;                             ///< per chart
};

/// The squares that charts are laid on.
struct PageRoom {
  int side = 0;    ///< of each, in texels
  int gutter = 0;  ///< empty texels between charts, and between pages
  int count = 1;
  /// Side of the atlas that the pages will lie on, at most: it sets how fine coordinates are. 0: as
  /// these pages need.
  int atlas_side = 0;
  std::vector<uint32_t> instance{};  ///< per chart; with several pages, those of one keep together
};

/// True where the squares have room for as many charts when each shrinks to a single texel.
bool holds_charts(const PageRoom& room, size_t charts);

/// The largest density on so many squares. first_guess > 0 is a density known to be nearly as large
/// as can be: taken when it fits. On several squares no chart may need more texels than one has:
/// the density ends there, however empty they stay. Error (bad_setting): the squares do not hold
/// the charts.
Result<Layout> layout_in_squares(const std::vector<FlatChart>& charts, const PageRoom& room,
                                 double first_guess, Progress& progress);
/// One square whose side is the smallest power of two below room.side (0: kMaxResolution), or that.
/// Error (bad_setting): not even the largest square is enough.
Result<Layout> layout_at_density(const std::vector<FlatChart>& charts, double texels_per_metre,
                                 PageRoom room, Progress& progress);
/// As many squares as it takes; room.count is not read. No chart may be longer than room.side.
/// Error: more than kMaxPages, or than an atlas holds.
Result<Layout> layout_on_fewest_pages(const std::vector<FlatChart>& charts, double texels_per_metre,
                                      PageRoom room, Progress& progress);

inline constexpr int kMaxResolution = 16384;

}  // namespace luxel::atlas
