// Packing of texel masks into a square.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/atlas/cover.h"
#include "luxel/base/progress.h"

namespace luxel::atlas {

/// The texels that a chart touches: per row, runs of columns in ascending order.
struct Mask {
  int width = 0, height = 0;
  std::vector<std::vector<Span>> rows;
  uint64_t texels = 0;
};

/// Texels touched by any triangle; all corners are at or right of and below the origin.
Mask make_mask(const std::vector<std::array<DVec2, 3>>& texels);
/// The mask turned by a quarter: texel (i, j) goes to (j, width - 1 - i).
Mask turned(const Mask& mask);

/// A chart laid in one direction, in every quarter turn that makes a difference: two for shapes
/// that nearly fill their rectangle, else four.
using Turns = std::vector<Mask>;
/// A chart in several directions, of which one is placed. The first one's size stands for the
/// chart's.
using Directions = std::vector<Turns>;
Turns all_turns(Mask upright);

struct ChartPosition {
  int x = 0, y = 0;   ///< on the page
  int turns = 0;      ///< quarter turns as turned() makes them
  int direction = 0;  ///< which of the chart's directions
  uint32_t page = 0;
};

struct Packing {
  std::vector<ChartPosition> places;
  int height = 0;     ///< rows in use, of all pages
  double placed = 0;  ///< share of the mask texels that found room: 1 when all fit
};

/// Several squares.
struct PackPages {
  uint32_t count = 1;
  std::vector<uint32_t> wished;  ///< per chart, the page to look for room first; empty: page 0
};

enum class Order : uint8_t { longest_side_first, largest_outline_first };

/// Places charts, large ones first, each at the topmost place in a square where it keeps `gutter`
/// empty texels to the ones before it. Small charts so fill the holes in and between large ones.
/// With several pages, on the wished one, or where that has no room, on the next that has. Stops at
/// the first that finds no room, and when cancelled.
Packing pack_masks(const std::vector<Directions>& charts, int side, int gutter, Order order,
                   const Progress& progress, const PackPages& pages = {});

}  // namespace luxel::atlas
