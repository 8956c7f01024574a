// Checks that the settings of a picture make sense together.
#pragma once

#include "luxel/base/result.h"
#include "luxel/pipeline/render/render.h"

namespace luxel::pipeline {

/// Errors (bad_setting): an unknown technique, a number out of range, an output that cannot be
/// written, and whatever the technique would not look at.
Status check(const RenderSettings& settings);

}  // namespace luxel::pipeline
