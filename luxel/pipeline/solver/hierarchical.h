// The options of hierarchical radiosity, which `luxel render` and `luxel probe` have, too.
#pragma once

#include "luxel/pipeline/settings/option.h"
#include "luxel/solve/hierarchical/light_mesh.h"

namespace luxel::pipeline {

struct HierarchicalSettings {
  hierarchical::SolveParams solve;
  hierarchical::MeshParams mesh;
};

/// The rows of those parameters that a user chooses.
Options<HierarchicalSettings> hierarchical_options();

inline constexpr std::string_view kHierarchicalHeading = "Hierarchical radiosity";

}  // namespace luxel::pipeline
