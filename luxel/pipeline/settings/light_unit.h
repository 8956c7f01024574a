// The unit that light comes out in. luxel converts nothing: candela in, lux out.
#pragma once

#include <filesystem>
#include <string>

#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// The unit of E, and how it is known.
struct LightUnit {
  std::string symbol;  ///< "lux" or "W/m^2"
  std::string reason;  ///< "--sky is in lux"
};

/// The unit of E in the light of `file`, which was read as `own`, and of `outside`. Lights of glTF
/// files are in candela, lux and nits by its specification, IES files in candela, --sky and --sun
/// in lux. A background and an environment map state no unit: beside a light in lux they are taken
/// for nits.
LightUnit unit_of_light(const std::filesystem::path& file, const scene::Scene& own,
                        const OutsideLight& outside);
/// The unit of E where add_outside_light() brought kDefaultSky (is_lit_by_default_day).
LightUnit unit_of_default_day();

}  // namespace luxel::pipeline
