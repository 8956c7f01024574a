// A guide of rays: cells of directions that are worth more of them.
//
// Light through a door comes from a small part of the hemisphere, and nearly all noise with it. The
// cells of directions (element_rays.h) are strata: with n_c rays in cell c, the mean over all cells
// has the variance sum sigma_c^2 / n_c over 64^2. It is least for a number of rays when n_c is in
// proportion to sigma_c (Neyman's allocation) [Cochran77, section 5.5]. Rays of a cell are
// stratified, so that their variance falls like n_c^-1.4, faster than 1 / n_c: then n_c goes with
// sigma_c^(1 / 1.2). Counts are powers of two, and each cell has a ray at least.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/bytes_per_entry.h"
#include "luxel/solve/gather/rays/element_rays.h"

namespace luxel::gather {

/// Levels of a guide: level k from 1 on has about 64 times 2^(k / 2) rays for an element.
inline constexpr int kGuideLevels = 10;

/// The guide of a group of neighbours: rays of each cell of directions, level by level.
struct GuidedGroup {
  std::array<float, kCells> doublings;  ///< of each cell, before shifts and rounding
  struct Level {
    float shift = 0;  ///< added to doublings
    float rays = 0;   ///< with a sample in each cell that has no doublings
    float left = 0;   ///< of the variance, over that of equal shares with a ray for each cell
  };
  std::array<Level, kGuideLevels> levels;  ///< from level 1 on

  const Level& level(int k) const { return levels[size_t(k - 1)]; }
};

/// The group of standard deviations, which are not negative. Nothing of it is known where all are
/// 0: then its levels leave all of the variance.
GuidedGroup guided_group(std::span<const float, kCells> deviations);

/// A group's shares at a level from 1 on.
CellShares shares_at(const GuidedGroup& group, int level);

/// Groups of elements.
struct Guide {
  std::vector<GuidedGroup> groups;
  /// A number of `groups`, or kNoGuide; empty: nothing is known.
  std::vector<uint32_t> of_element;
};
inline constexpr uint32_t kNoGuide = UINT32_MAX;
/// Fewer elements are no group: what tells of their directions would take more rays than they do.
inline constexpr size_t kFewestInGroup = 16;
inline constexpr uint64_t kGuideBytesPerElement =
    bytes_per_entry(&Guide::of_element) + sizeof(GuidedGroup) / kFewestInGroup;

}  // namespace luxel::gather
