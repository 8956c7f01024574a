// The options of hemicube radiosity, which `luxel render` has, too.
#pragma once

#include "luxel/pipeline/settings/option.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/solve/hemicube/hemicube.h"

namespace luxel::pipeline {

/// The rows of the solver's parameters that a user chooses.
Options<hemicube::HemicubeParams> hemicube_options();
/// The solver's parameters by these settings, memory and folders aside: four shadow rays for each
/// of --direct-samples.
hemicube::HemicubeParams hemicube_params(const BakeSettings& settings);
/// Contradictions between them. Errors (bad_setting).
Status check_contradictions(const hemicube::HemicubeParams& params);

inline constexpr std::string_view kHemicubeHeading = "Hemicube radiosity";

}  // namespace luxel::pipeline
