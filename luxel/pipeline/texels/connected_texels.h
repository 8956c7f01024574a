// Regions of texels that no wall parts: light can be the same on them. docs/method/leaks.md
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/light/texel_scene.h"

namespace luxel::pipeline {

/// Per texel, the least number of those that it hangs together with: over neighbours of its chart,
/// and over seams, that are open to each other (transport::is_open_between). Those inside of solids
/// (1 in `hidden`, one per texel) hang together with none: a wall may be so thick that it hides the
/// texels under it, and the chart goes on. So texels of a closed room have numbers of their own.
/// The members of a team share out what asks for rays. The stage "neighbours". Errors: cancelled,
/// another member of the team gives up.
Result<std::vector<uint32_t>> connected_texels(const light::TexelScene& in,
                                               std::span<const uint8_t> hidden, Progress& progress,
                                               Team* team = nullptr);

}  // namespace luxel::pipeline
