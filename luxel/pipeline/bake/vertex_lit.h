// A solution as a scene: the solver's mesh with its light as vertex colours.
#pragma once

#include "luxel/scene/scene.h"
#include "luxel/solve/hemicube/field.h"

namespace luxel::pipeline {

struct VertexLit {
  scene::Scene scene;   ///< one mesh per instance, in the world; materials unlit
  float intensity = 1;  ///< colors * intensity = E [W/m^2], times the scene's own vertex colours
};

/// Vertices are split where light per triangle jumps. White is the 99.9th percentile of the
/// largest channel, as in the lightmap's picture.
VertexLit vertex_lit(const scene::Scene& scene, const hemicube::Field& field);

}  // namespace luxel::pipeline
