// Settings that bakes on a graphics device cannot have.
#pragma once

#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// The keepers of a bake with these settings: without a device that is optional and cannot have it,
/// of which `warnings` says why. Errors (bad_setting): a device that is not optional cannot have
/// it.
Result<Keepers> settle_device(const BakeSettings& settings, const Keepers& keepers,
                              std::vector<std::string>& warnings);

}  // namespace luxel::pipeline
