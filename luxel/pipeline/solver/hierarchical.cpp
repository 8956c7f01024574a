#include "luxel/pipeline/solver/hierarchical.h"

namespace luxel::pipeline {

hierarchical::SolveParams solve_params(const HierarchicalSettings& settings, int bounces) {
  hierarchical::SolveParams params;
  params.eps = settings.eps;
  params.min_area_m2 = settings.min_area_m2;
  params.bounces = bounces;
  return params;
}

hierarchical::MeshParams light_mesh_params(const HierarchicalSettings& settings) {
  hierarchical::MeshParams params;
  params.discontinuities = settings.discontinuities;
  params.discontinuity.max_per_leaf = uint32_t(settings.max_leaf_lines);
  params.discontinuity.least_weight = settings.min_weight;
  params.discontinuity.ranking = settings.ranking == "nearness" ? hierarchical::Ranking::nearness
                                                                : hierarchical::Ranking::slope;
  return params;
}

}  // namespace luxel::pipeline
