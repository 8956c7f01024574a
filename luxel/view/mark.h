// Marks drawn over a picture, to be taken hold of.
#pragma once

#include <array>

#include "luxel/base/vec.h"

namespace luxel::view {

/// A disc, or a line with round ends. Places are pixels, (0, 0) the top left corner.
struct Mark {
  Vec2 from, to;
  float radius = 1;    ///< [pixels]
  Rgb color{1, 1, 1};  ///< display values
  Rgb edge{0, 0, 0};
  float edge_width = 0;  ///< outside of the radius [pixels]
};

}  // namespace luxel::view
