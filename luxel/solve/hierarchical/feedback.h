// Feeds exact light at points back to the solution that it was computed from.
#pragma once

#include "luxel/solve/hierarchical/light_mesh.h"

namespace luxel::hierarchical {

/// Defect correction [Stetter78]. Interpolants are one exact gather of the light there is; links
/// had brought something else, by what their form factors, clusters and borders of shadows inside
/// of elements are off. The difference is added to what links bring, element by element, and light
/// iterated anew: whatever links bring wrongly is wrong by the second order from then on. Leaves
/// get their triangles as pieces, which points near them gather from instead of linear light. Only
/// for light of all bounces: counted ones have no fixed point. Returns the root mean
/// square of what leaves' light changed by [W/m^2]. Errors: cancelled.
Result<double> feed_back(Solution& solution, const trace::RayTracer& tracer, const LightMesh& mesh,
                         Progress& progress);

/// The linear function over a quadratic one's triangle that is nearest in the mean square: its
/// values at the corners.
std::array<Rgb, 3> linear_of(const Interpolant& r);

}  // namespace luxel::hierarchical
