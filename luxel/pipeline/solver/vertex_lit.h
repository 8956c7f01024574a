// A solution as a scene: the solver's mesh with its light as vertex colours.
#pragma once

#include "luxel/pipeline/texels/solve_input.h"
#include "luxel/solve/hemicube/field.h"

namespace luxel::pipeline {

/// Vertices are split where light per triangle jumps. White is the 99.9th percentile of the
/// largest channel, as in the lightmap's picture.
VertexLit vertex_lit(const scene::Scene& scene, const hemicube::Field& field);

}  // namespace luxel::pipeline
