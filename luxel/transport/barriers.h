// Barriers: what stands on a surface, parts the light on it, and is no thicker than texels are.
//
// A lookup in a lightmap mixes four texels. Where a wall stands on a floor, those of one room mix
// with those of the next unless texels that nobody sees lie between: light leaks through the wall.
#pragma once

#include <optional>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/cut_charts.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::transport {

/// A place on the front of a surface.
struct FlatPoint {
  Vec3 position, normal;  ///< world; the geometric normal
};
FlatPoint flat_point(const scene::Scene& scene, const scene::SurfacePoint& p);

/// What parts two neighbouring places: something opaque that cuts the lines between them half a
/// step, one step and two steps above the surface, a step being `step_m`. A fence of less than two
/// texels' height is no barrier, because light comes over it within a texel. The surface itself,
/// `chart`, bends without being one. Returns the plane of what stands nearest to `a`.
std::optional<Plane> barrier_between(const scene::Scene& scene, const atlas::Atlas& atlas,
                                     const trace::RayTracer& tracer, uint32_t chart,
                                     const FlatPoint& a, const FlatPoint& b, float step_m);

/// The samples of all pairs of texels of one chart that lie side by side or next but one in a row
/// or a column, both in the open, that a barrier parts. In the order of the texels.
std::vector<atlas::PartedPoints> find_parted(const scene::Scene& scene, const atlas::Atlas& atlas,
                                             const atlas::TexelMap& map,
                                             const trace::RayTracer& tracer);

}  // namespace luxel::transport
