// The parameters of gather for a bake that asks for a number of samples, an error, or a time.
#pragma once

#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// With max_error or a time budget, the parameters of the first round.
gather::GatherParams gather_params(const BakeSettings& settings);

/// Where it stores hits; nothing is kept, and all memory may be used.
gather::GatherStores gather_stores(const BakeSettings& settings);

}  // namespace luxel::pipeline
