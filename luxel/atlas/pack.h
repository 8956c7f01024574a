// Packing of charts' masks into a square.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/atlas/pieces.h"
#include "luxel/base/progress.h"

namespace luxel::atlas {

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
Packing pack_pieces(const Pieces& pieces, int side, int gutter, Order order,
                    const Progress& progress, const PackPages& pages = {});

}  // namespace luxel::atlas
