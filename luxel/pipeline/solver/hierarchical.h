// What settings ask of solve/hierarchical.
#pragma once

#include "luxel/pipeline/settings/settings.h"
#include "luxel/solve/hierarchical/light_mesh.h"

namespace luxel::pipeline {

/// `bounces` < 0: all.
hierarchical::SolveParams solve_params(const HierarchicalSettings& settings, int bounces);
hierarchical::MeshParams light_mesh_params(const HierarchicalSettings& settings);

}  // namespace luxel::pipeline
