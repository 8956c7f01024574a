// Pieces to pack: the masks of all charts, equal ones once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/atlas/mask.h"
#include "luxel/atlas/strip.h"

namespace luxel::atlas {

/// A chart laid in one direction, in every quarter turn that makes a difference: two for shapes
/// that nearly fill their rectangle, else four. Their numbers among the pieces' masks.
struct Turns {
  std::array<uint32_t, 4> mask{};
  uint32_t count = 0;
};
/// A chart in several directions, of which one is placed. The first one's size stands for the
/// chart's.
using Directions = std::vector<Turns>;

/// Scenes repeat themselves: of a city's 40,000 masks 1,000 are different. What is known of one
/// holds for all that are equal.
struct Pieces {
  std::vector<Directions> charts;
  std::vector<Mask> masks;
  std::vector<Shape> shapes;  ///< of each mask

  /// The chart's mask in its first direction, not turned.
  const Mask& upright(size_t chart) const { return masks[charts[chart].front().mask.front()]; }
};

/// The pieces of charts; per chart, the mask in each direction, not turned.
Pieces make_pieces(std::vector<std::vector<Mask>> charts);

}  // namespace luxel::atlas
