// In which directions charts may lie on the atlas.
#pragma once

#include <vector>

#include "luxel/atlas/project.h"

namespace luxel::atlas {

/// A chart as it is, and perhaps turned by parts of a quarter.
using TurnedChart = std::vector<FlatChart>;

/// Blobs leave wide voids between them unless they are fitted to each other: the large ones among
/// them may lie in eight directions, where most of the area is in blobs (it is slow) or they are
/// few. A rectangle or a sliver wastes least upright, and small charts fill voids as they are.
std::vector<TurnedChart> directions_of(const std::vector<FlatChart>& charts);

/// Area of all charts in their planes.
double flat_area(const std::vector<FlatChart>& charts);

}  // namespace luxel::atlas
