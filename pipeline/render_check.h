// Whether the settings of a picture make sense together.
#pragma once

#include "base/result.h"
#include "pipeline/render.h"

namespace luxel::pipeline {

/// Errors (bad_setting): an unknown technique, a number out of range, an output that cannot be
/// written, and whatever the technique would not look at.
Status check(const RenderSettings& settings);

}  // namespace luxel::pipeline
