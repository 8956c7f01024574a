// The options of hierarchical radiosity, which `luxel render` and `luxel probe` have, too.
#pragma once

#include "luxel/pipeline/settings/option.h"
#include "luxel/solve/hierarchical/represent.h"

namespace luxel::pipeline {

struct HierarchicalSettings {
  hierarchical::SolveParams solve;
  hierarchical::MeshParams mesh;
};

/// The rows of those parameters that a user chooses.
Options<HierarchicalSettings> hierarchical_options();

/// The sentence about what --time-budget, so many seconds, has left out; something was.
std::string about_left_out(const hierarchical::LeftOut& left_out, double budget_s);

inline constexpr std::string_view kHierarchicalHeading = "Hierarchical radiosity";

}  // namespace luxel::pipeline
