// Barriers: what stands on a surface, parts the light on it, and is no thicker than texels are.
//
// A lookup in a lightmap mixes four texels. Where a wall stands on a floor, those of one room mix
// with those of the next unless texels that nobody sees lie between: light leaks through the wall.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/cut_charts.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::transport {

/// A place on the front of a surface.
struct FlatPoint {
  Vec3 position, normal;  ///< world; the geometric normal
  float size_m = 0;       ///< of its triangle, scene::size_for_rounding()
};
FlatPoint flat_point(const scene::Scene& scene, const scene::SurfacePoint& p);
/// Where rays start there: off the surface by what rounding may do.
Vec3 just_above(const FlatPoint& p);

/// True where a hit of a line between two places of `chart` parts them: the surface there is opaque
/// and not the places' own, which bends without being a barrier.
bool is_barrier(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t chart,
                const trace::Hit& hit);

/// The barrier between two neighbouring places: something opaque that cuts the line between them
/// half a step above the surface, a step being `step_m`, and the ways up, across and down at one
/// step and at two. A fence of less than two texels' height is no barrier, because light comes over
/// it within a texel. The surface itself, `chart`, bends without being one. Returns the plane of
/// the surface that the line meets first.
std::optional<Plane> barrier_between(const scene::Scene& scene, const atlas::Atlas& atlas,
                                     const trace::RayTracer& tracer, uint32_t chart,
                                     const FlatPoint& a, const FlatPoint& b, float step_m);

/// The samples of all pairs of texels of one chart, at most two texels apart in rows and in columns
/// and both in the open, that a barrier parts, and around which no way leads from neighbour to
/// neighbour within three texels; of those two texels apart the ones with a barrier, or no texel,
/// right beside the first. A look-up mixes both, or one with a hidden texel between them that
/// has the light of the other. In the order of the texels. The members of a team share the texels
/// out. The stage "walls". Errors: cancelled, another member of the team gives up.
Result<std::vector<atlas::PartedPoints>> find_parted(const scene::Scene& scene,
                                                     const atlas::Atlas& atlas,
                                                     const atlas::TexelMap& map,
                                                     const trace::RayTracer& tracer,
                                                     Progress& progress, Team* team = nullptr);

/// A place of a chart.
struct ChartPoint {
  FlatPoint at;
  uint32_t chart = 0;
};
/// True where light can be the same at two neighbouring places: nothing opaque is in the way of one
/// of the ways up, across and down at a twentieth of a step above the surface, a half, one and two.
/// Both charts bend without being in the way. A wall that leans over the surface, inside of which
/// barrier_between() may begin, is seen.
bool is_open_between(const scene::Scene& scene, const atlas::Atlas& atlas,
                     const trace::RayTracer& tracer, const ChartPoint& a, const ChartPoint& b,
                     float step_m);

/// Calls visit(a, b) for all texels of one chart that are neighbours in a row, a column or a
/// diagonal and open to each other (is_open_between), once for each pair, in the order of the
/// texels. The members of a team share the texels out, and all visit all pairs. The stage
/// "neighbours". Errors: cancelled, another member of the team gives up.
Status for_open_neighbours(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const atlas::TexelMap& map, const trace::RayTracer& tracer,
                           const std::function<void(uint32_t, uint32_t)>& visit, Progress& progress,
                           Team* team = nullptr);

}  // namespace luxel::transport
