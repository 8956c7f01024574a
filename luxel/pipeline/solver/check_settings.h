// Whether a bake's settings can be met.
#pragma once

#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// check_values(), and whether there is such a solver and it can do what is asked. Errors
/// (bad_setting) name the option, the value, and what works.
Status check(const BakeSettings& settings);

}  // namespace luxel::pipeline
