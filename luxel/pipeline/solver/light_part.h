// The part of the light that --light asks for.
#pragma once

#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/texels/solve_input.h"
#include "luxel/solve/gather/gather.h"

namespace luxel::pipeline {

/// Leaves of `light`, which is all of it, what `part` names. Errors become relative to that; they
/// stay those of all light, which are larger than those of a part. Nothing is done for `all`.
void take_part(LightPart part, const gather::SourceLight& sources, TexelLight& light);

}  // namespace luxel::pipeline
