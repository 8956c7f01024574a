// What bakes on a graphics device cannot be asked for.
#pragma once

#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// The keepers of a bake with these settings: none but the device, or no device. Where the device
/// is optional and cannot have the bake, `warnings` says why. Errors (bad_setting): it is not
/// optional.
Result<Keepers> settle_device(const BakeSettings& settings, const Keepers& keepers,
                              std::vector<std::string>& warnings);

}  // namespace luxel::pipeline
