// Where rays that meet a triangle land in the lightmap, for shaders.
#pragma once

#include <vector>

#include "luxel/solve/device/land_shared.h"
#include "luxel/solve/gather/trace/sort_rays.h"

namespace luxel::device {

/// Two of each drawn triangle, in the order of atlas::Atlas::triangle_number: what rays meet that
/// come from its front, and from behind.
std::vector<on_device::Landing> landings_of(const gather::RayScene& in);

}  // namespace luxel::device
