// Several pictures on one sheet, each with its name under it.
#pragma once

#include <span>
#include <string>

#include "luxel/image/codec.h"

namespace luxel::display {

struct Tile {
  std::string label;
  image::Image8 picture;
};

/// The number of tiles side by side that makes the sheet's own shape nearest to 4 : 3.
int columns_for(size_t tiles, int tile_width, int tile_height);

/// The tiles row by row, three channels, on light grey. Labels are cut off at their tile's width.
/// All tiles have one size and at least three channels; there is at least one.
image::Image8 contact_sheet(std::span<const Tile> tiles);

}  // namespace luxel::display
