// Light along a line on a surface, and over an element: exact, as it is shown, and the difference.
// [Hardt96, appendix B.4.7]
#pragma once

#include "luxel/view/hierarchical/probe.h"

namespace luxel::view {

/// A line on a face [m].
struct CurveLine {
  uint32_t face = 0;
  DVec3 from, to;
};

/// Light at points of a line or over an area; differences are shown less exact.
struct Curve {
  CurveLine line;
  std::vector<float> at_m;        ///< of each point, from the beginning of the line
  std::vector<Rgb> exact, shown;  ///< E [W/m^2]
  double rms = 0, most = 0;       ///< of the difference's luminance [W/m^2]
  double relative_rms = 0;        ///< over the mean of the exact one; 0 in the dark
};

/// Points that are computed at once, and their tolerance.
struct CurveParams {
  size_t points = 192;
  hierarchical::PointParams point = {.tolerance = 1e-5};
};
/// At points in the middles of equal parts of the line. Errors: cancelled.
Result<Curve> curve_along(const SolutionView& view, const CurveLine& line, const ShownLight& shown,
                          const CurveParams& params, Progress& progress);

/// The part of a line that lies on its face, both ends brought to its plane; none where nothing
/// does.
std::optional<CurveLine> clipped(const SolutionView& view, const CurveLine& line);
/// Through the middle of a convex polygon of a face, as long as it goes, along its longest edge.
CurveLine line_across(hierarchical::PolygonView polygon, uint32_t face);
/// Across the middle of a discontinuity, `reach_m` to both sides, as far as its face goes.
std::optional<CurveLine> line_across(const SolutionView& view, uint32_t face,
                                     const hierarchical::Discontinuity& discontinuity,
                                     double reach_m);

/// Light over a convex polygon of a face, in a grid: the graph of [Hardt96], drawn in space.
struct LightSurface {
  uint32_t face = 0;
  std::vector<DVec3> places;                   ///< [m]
  std::vector<std::array<uint32_t, 2>> edges;  ///< of the grid, pairs of places
  std::vector<Rgb> exact, shown;               ///< E [W/m^2], of each place
  double rms = 0, most = 0;                    ///< of the difference's luminance [W/m^2]
};
/// `cells` along each side; three or four corners. Errors: cancelled.
Result<LightSurface> surface_over(const SolutionView& view, hierarchical::PolygonView polygon,
                                  uint32_t face, size_t cells, const ShownLight& shown,
                                  const hierarchical::PointParams& point, Progress& progress);

/// A value for each leaf.
ShownLight light_of_leaves(const SolutionView& view);
/// Linear between the corners of the light mesh's triangles, and quadratic over them. The mesh must
/// be there.
ShownLight linear_light(const SolutionView& view);
ShownLight quadratic_light(const SolutionView& view);

/// Lines for a panel. `unit`: of E.
std::vector<std::string> lines_of(const Curve& curve, const std::string& unit);

}  // namespace luxel::view
