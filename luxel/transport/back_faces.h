// Decides if a place lies inside a solid, by its back-face fraction: the share of its view that the
// backs of surfaces take. This is the one rule of all solvers, and of the path tracer.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::transport {

/// The back-face fraction as counts: how many of `rays` rays met the back of a one-sided surface,
/// and how many that of a surface that reflects from behind too (scene::reflects_from_behind).
struct BackFaces {
  int rays = 0, one_sided = 0, double_sided = 0;
};
/// The back-face fraction as shares of the hemisphere, such as sums of form factors.
struct BackFaceShares {
  float one_sided = 0, double_sided = 0;
};

/// One-sided and double-sided.
inline int64_t all_backs(const BackFaces& b) { return int64_t(b.one_sided) + b.double_sided; }

/// More than a half of what the place sees is the back of one-sided surfaces: a closed solid with
/// its front outside. Light there is of no use.
inline bool is_hidden(const BackFaces& b) { return 2 * int64_t(b.one_sided) > b.rays; }
inline bool is_hidden(const BackFaceShares& b) { return b.one_sided > 0.5f; }

/// The place is hidden, or sees nothing but backs, also of double-sided surfaces: the floor under a
/// box. Many exporters call every material double-sided. Two of a hundred may be fronts, because
/// rays that pass along an edge may meet one. Counts reach the limit exactly and are enclosed
/// there; shares are sums of rounded numbers, for which the limit itself means nothing.
inline bool is_enclosed(const BackFaces& b) {
  return is_hidden(b) || 100 * all_backs(b) >= 98 * int64_t(b.rays);
}
inline bool is_enclosed(const BackFaceShares& b) {
  return is_hidden(b) || b.one_sided + b.double_sided > 0.98f;
}

/// Counts the backs that `rays` rays meet, 64 at most, cosine-distributed about `normal`, the same
/// set for every place. They start at `from`, which lies just off the surface (scene::off_surface).
BackFaces count_back_faces(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                           Vec3 normal, int rays);

/// True where a place lies inside a solid, by so many of those rays. Where nearly all of them see
/// backs, but not all, 64 decide. A front that sees nothing but backs then counts as a back, unless
/// it shines: rays to the floor within a box whose bottom lies just as high meet either of the two.
bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
                 int rays);

/// True where a place lies outside of solids, by 8 to 32 of those rays, and by 64 where nearly all
/// of them see backs. A few rays mostly tell: most places see no backs, and most under things see
/// nothing else.
bool is_in_the_open(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                    Vec3 normal);

/// True where element i lies inside a solid. `own`: the backs that its own rays met. Where they are
/// not sure, a fixed set decides, so that other samples or another seed do not turn a texel on and
/// off, and solvers agree.
bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                 const Elements& elements, size_t i, const BackFaces& own);
/// Per element, 1 where it lies inside a solid, else 0. `own(i)` is what its own rays met.
std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements,
                                   const std::function<BackFaces(size_t)>& own);
/// By the fixed set alone, for solvers whose elements have no rays of their own.
std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements);

}  // namespace luxel::transport
