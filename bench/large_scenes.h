// Scenes of any number of triangles, outdoors under a sun and an even sky.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::bench {

/// Hills of 100 x 100 m: one mesh of 2 quads^2 triangles, on which every vertex lies at a height
/// of its own.
scene::Scene hills(int quads);

/// A plain on which copies of one rock lie, each turned in its own way: 20 * 4^levels triangles are
/// stored for `copies` times as many that are drawn.
scene::Scene rocks(int levels, int copies);

}  // namespace luxel::bench
