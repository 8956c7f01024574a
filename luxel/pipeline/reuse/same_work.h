// Checks that the members of a team are at the same work.
#pragma once

#include <cstdint>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// `more`: a digest of what else must be equal: options, or where texels lie. Null: there is no
/// team. Errors (bad_input): a member has another scene, or another `more`; another member gives
/// up.
Status check_same_work(Team* team, const scene::Scene& scene, uint64_t more, Progress& progress);

}  // namespace luxel::pipeline
