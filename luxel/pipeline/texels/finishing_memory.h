// What the steps after a solver take of memory, in bytes per texel of the map.
#pragma once

#include <cstdint>

namespace luxel::pipeline {

/// What denoising needs besides: places, planes, what neighbours show, the level of noise.
inline constexpr uint64_t kDenoise = 140;
/// E for five normals and what becomes of it, with --directional.
inline constexpr uint64_t kDirection = 110;

}  // namespace luxel::pipeline
