// Finds the texels around a place that lie on its own side of every wall. docs/method/leaks.md
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::transport {

/// Where a bilinear look-up reads a lightmap with a border of one empty texel: around the texel
/// `base` = (y + 1) * (side + 2) + x + 1, its right and its lower neighbours.
struct LookupPlace {
  uint32_t base = 0;
  float fx = 0, fy = 0;  ///< how far the place is towards the lower right one, 0 .. 1
};
/// The place of a point of the surface.
LookupPlace lookup_place(const atlas::Atlas& atlas, const scene::SurfacePoint& p);
/// A place that reads no texel: light there is 0.
inline constexpr LookupPlace kReadsNothing{};

/// A scene's lightmap, and where it has texels of more than one side of a wall next to each other.
/// Refers to the others, which stay where they are while it is used.
struct OwnSides {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const atlas::TexelMap& map;
  const trace::RayTracer& tracer;
  /// Bits per LookupPlace::base. Sides meet in its four texels; or a solid hides some of them from
  /// others, whose light a place in the open reads alone.
  std::vector<uint64_t> mixed{}, beside_solids{};
  std::vector<uint64_t> under{};  ///< bits per texel: a wall leans over its sample

  bool is_mixed(uint32_t base) const { return mixed[base / 64] >> (base % 64) & 1; }
  bool is_under(uint32_t texel) const { return under[texel / 64] >> (texel % 64) & 1; }
  bool is_beside_solids(uint32_t base) const { return beside_solids[base / 64] >> (base % 64) & 1; }
};

/// Yes: a place may lie inside a solid, as on a path that began in the joint of two solids.
enum class MayBeInside : bool { no, yes };

/// Looks for walls between the samples of neighbouring texels, in rows, columns and diagonals, and
/// within texels at the border of a chart. A line runs from place to place a twentieth of a texel
/// above the surface, lower at an end beside a wall that leans over it; what is_barrier() stops it.
/// Samples inside of solids do not count.
OwnSides find_own_sides(const scene::Scene& scene, const atlas::Atlas& atlas,
                        const atlas::TexelMap& map, const trace::RayTracer& tracer);
/// find_own_sides() shared out among the members of a team, if there is one. The stage "wall
/// sides". Errors: cancelled, another member gives up.
Result<OwnSides> find_own_sides(const scene::Scene& scene, const atlas::Atlas& atlas,
                                const atlas::TexelMap& map, const trace::RayTracer& tracer,
                                Team* team, Progress& progress);

/// Where light at a point is read: lookup_place() where its four texels have one side, else the
/// nearest place between those of them whose samples it sees; else the nearest of the texels around
/// them; else kReadsNothing. The same in every call.
LookupPlace own_lookup(const OwnSides& sides, const scene::SurfacePoint& p,
                       MayBeInside inside = MayBeInside::no);
/// True where own_lookup() reads something.
bool has_own_texel(const OwnSides& sides, const scene::SurfacePoint& p);

/// E of the front side at a surface point, read where own_lookup() says: bilinear over the texels
/// there. `irradiance` has one value per texel of the map.
Rgb own_irradiance_at(const OwnSides& sides, std::span<const Rgb> irradiance,
                      const scene::SurfacePoint& p);

/// Places, as bits per LookupPlace::base, at which own_lookup() may read something else if what
/// lies within `boxes` [m] becomes something else; kReadsNothing among them.
std::vector<uint64_t> lookups_near(const OwnSides& sides, std::span<const Box3> boxes);

/// Sets on_side[k] to 1 where points[k] of a texel's footprint lies on the side of its sample: it
/// sees the sample, or another point that does, but for points under something that lies less than
/// a twentieth of a texel above them: a way from there leads to others of this kind alone; else to
/// 0. Returns the number of rays.
uint64_t find_on_side(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const trace::RayTracer& tracer, const scene::SurfacePoint& sample,
                      std::span<const scene::SurfacePoint> points, std::span<uint8_t> on_side);

}  // namespace luxel::transport
