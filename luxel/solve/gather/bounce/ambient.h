// A guess of all bounces from direct light.
#pragma once

#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

/// Light that surfaces send each other, if it is spread evenly: of what they reflect of the direct
/// light, the part rho that the next reflection leaves, and so on [Cohen88, section 5]. Exact where
/// direct light and reflectance are the same everywhere and nothing is open.
std::vector<Rgb> with_ambient(const transport::Elements& elements, std::span<const Rgb> direct);

}  // namespace luxel::gather
