// Faces that lie together in a chart.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/atlas/faces.h"
#include "luxel/base/progress.h"

namespace luxel::atlas {

/// The faces of a chart: connected over edges, normals within max_angle of the chart's axis.
using ChartFaces = std::vector<uint32_t>;

/// The chart's axis: the mean normal, weighted by area.
DVec3 chart_axis(const Faces& faces, const ChartFaces& chart);

/// Merges faces into flat patches, and patches into charts, the pair that loses least flatness
/// first. [Garland01, section 3; the error is that of CohenSteiner04, section 3.2]
/// Returns nothing when cancelled.
std::vector<ChartFaces> grow_charts(const Faces& faces, double max_angle, const Progress& progress);

/// The parts of a set of faces that hang together over edges.
std::vector<ChartFaces> connected_parts(const Faces& faces, const ChartFaces& set);

}  // namespace luxel::atlas
