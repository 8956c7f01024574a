// From groups of faces to places on one page or several.
#pragma once

#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/fit_charts.h"

namespace luxel::atlas {

struct LaidOut {
  std::vector<FlatChart> charts;
  Layout layout;
};

/// Flattens the groups and lays them out as `params` say, cutting charts that overlap themselves at
/// the texels they get. Errors: as make_atlas.
Result<LaidOut> lay_out(const scene::Scene& scene, const Faces& faces,
                        const std::vector<ChartFaces>& groups, const AtlasParams& params,
                        Progress& progress);

}  // namespace luxel::atlas
