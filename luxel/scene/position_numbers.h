// Numbers that tell which vertices of a mesh lie at one position.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::scene {

/// A number per position, the same for positions that are equal, bit for bit but for the sign of
/// zero: exporters split vertices along UV seams and hard edges, and the copies are equal. Numbers
/// run from 0 without gaps.
std::vector<uint32_t> position_numbers(std::span<const Vec3> positions);

}  // namespace luxel::scene
