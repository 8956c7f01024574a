// Whether a place lies inside a solid: what it sees are the backs of surfaces.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::transport {

/// Of `rays` rays, how many met the back of a one-sided surface, or of one that reflects from
/// behind too (scene::reflects_from_behind).
struct BacksSeen {
  int rays = 0, one_sided = 0, double_sided = 0;
};

inline int backs_in(const BacksSeen& seen) { return seen.one_sided + seen.double_sided; }

/// 64 rays at most, cosine-distributed about `normal`, the same set for every place. They start at
/// `from`, which lies just off the surface (trace::offset_origin).
BacksSeen backs_seen(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                     Vec3 normal, int rays);

/// Most of what it sees is the back of one-sided surfaces: light there means nothing to anybody.
inline bool is_hidden(const BacksSeen& b) { return 2 * b.one_sided > b.rays; }
/// It is hidden or sees nothing but backs, also of double-sided surfaces: the floor under a box.
/// Many exporters call every material double-sided.
inline bool is_enclosed(const BacksSeen& b) {
  return is_hidden(b) || 100 * backs_in(b) >= 98 * b.rays;
}

/// Whether a place lies inside a solid, by so many of those rays. Where nearly all of them see
/// backs, but not all, 64 decide, for which a front that sees nothing but backs is as good as one,
/// unless it shines: of the floor within a box whose bottom lies just as high rays meet either.
bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
                 int rays, float diagonal_m);

/// Whether element i lies inside a solid. `own` is what its own rays met; where they are not sure,
/// a fixed set decides, so that other samples or another seed do not turn a texel on and off, and
/// solvers agree.
bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                 const Elements& elements, size_t i, const BacksSeen& own, float diagonal_m);
/// The same per element, as 1 or 0.
std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements,
                                   const std::function<BacksSeen(size_t)>& seen);

}  // namespace luxel::transport
