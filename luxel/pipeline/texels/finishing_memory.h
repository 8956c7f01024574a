// The memory of the steps after a solver, in bytes per texel of the map.
#pragma once

#include <cstdint>

namespace luxel::pipeline {

/// The denoiser's own: places, planes, light shown to neighbours, the level of noise.
inline constexpr uint64_t kDenoise = 140;
/// E for five normals and what becomes of it, with --directional.
inline constexpr uint64_t kDirection = 110;

}  // namespace luxel::pipeline
