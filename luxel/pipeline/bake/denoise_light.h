// A solver's light without its grain: what `luxel bake --denoise` adds.
#pragma once

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// Filters the direct part and the rest apart, for the edges of shadows are in the one and most of
/// the noise is in the other. Errors: cancelled.
Status denoise_light(const light::TexelScene& in, TexelLight& light, Progress& progress);

}  // namespace luxel::pipeline
