// The texels that a chart touches.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/cover.h"

namespace luxel::atlas {

/// Runs of columns of one row after the other, in ascending order and apart from each other: two
/// masks of the same texels are equal.
struct Mask {
  int width = 0, height = 0;
  std::vector<Span> runs;           ///< of all rows
  std::vector<uint32_t> first_run;  ///< per row, one extra entry at the end
  uint64_t texels = 0;

  std::span<const Span> row(int j) const {
    return {runs.data() + first_run[size_t(j)], runs.data() + first_run[size_t(j) + 1]};
  }
  friend bool operator==(const Mask&, const Mask&) = default;
};

/// Columns of one row.
struct RowRun {
  int row = 0;
  Span columns;
};
/// The mask of this size that holds these runs, in any order; they may overlap.
Mask mask_of(int width, int height, std::span<const RowRun> runs);

/// Texels touched by any triangle; all corners are at or right of and below the origin.
Mask make_mask(const std::vector<std::array<DVec2, 3>>& texels);
/// The mask turned by a quarter: texel (i, j) goes to (j, width - 1 - i).
Mask turned(const Mask& mask);
/// The mask's texels and all within `gutter` of them, in rows and in columns; (0, 0) goes to
/// (gutter, gutter).
Mask widened(const Mask& mask, int gutter);

}  // namespace luxel::atlas
