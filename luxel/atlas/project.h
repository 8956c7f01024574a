// Charts laid flat: parallel projection along the chart's axis, then cut where that does not
// cutting.
#pragma once

#include <array>
#include <vector>

#include "luxel/atlas/charts.h"
#include "luxel/atlas/faces.h"
#include "luxel/atlas/plane.h"

namespace luxel::atlas {

/// A chart in its own plane, in metres: the smallest rectangle around it is [0, size.x] x [0,
/// size.y]. Its area is that of the surface, so that all charts have one density.
struct FlatChart {
  ChartFaces faces;
  std::vector<std::array<DVec2, 3>> corners;  ///< per face
  DVec2 size;
};

/// Projects a chart along its axis, scales it to the surface's area and turns it into the smallest
/// rectangle around it.
FlatChart project_chart(const Faces& faces, ChartFaces chart);

/// Faces of a chart that cover a texel centre which an earlier face (breadth-first over the
/// surface) covers too; empty for a chart that does not overlap itself. `texels` are the chart's
/// corners.
ChartFaces overlapping_faces(const Faces& faces, const FlatChart& chart,
                             const std::vector<std::array<DVec2, 3>>& texels);

/// Projects charts and cuts those that fold over themselves, and those longer than max_length as
/// far as whole triangles go. `texels_per_metre` is about the density that the chart will get.
std::vector<FlatChart> flatten_charts(const Faces& faces, std::vector<ChartFaces> charts,
                                      double max_length, double texels_per_metre,
                                      const Progress& progress);

/// The chart without some of its faces, and those faces, as charts of their own.
std::vector<ChartFaces> cut_out(const Faces& faces, const ChartFaces& chart,
                                const ChartFaces& away);

}  // namespace luxel::atlas
