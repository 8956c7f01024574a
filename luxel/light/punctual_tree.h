// The hierarchy of point and spot lights, for lights that are put together by hand.
#pragma once

#include "luxel/light/lights.h"

namespace luxel::light {

/// Fills punctual_nodes and punctual_order for what is in `punctual`; collect_lights() has done so.
/// Where there are more lights than shadow rays, only those in the hierarchy are looked at.
void build_punctual_tree(Lights& lights);

}  // namespace luxel::light
