// A solver's light without its grain: what `luxel bake --denoise` adds.
#pragma once

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// Filters the direct part and the rest apart, for the edges of shadows are in the one and most of
/// the noise is in the other. With repair_leaks, light stays among charts that hang together by
/// seams on which no barrier stands all along: charts are cut where walls stand on them, so none
/// gets into a closed room. Errors: cancelled.
Status denoise_light(const light::TexelScene& in, bool repair_leaks, TexelLight& light,
                     Progress& progress);

}  // namespace luxel::pipeline
