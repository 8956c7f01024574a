// View factors by casting rays: independent of every formula.
#pragma once

#include <span>

#include "luxel/trace/ray_tracer.h"
#include "luxel/viewfactor/factor_matrix.h"
#include "luxel/viewfactor/hemicube.h"

namespace luxel::viewfactor {

struct SampledParams {
  uint32_t samples = 1u << 18;  ///< by rays: rays per surface; by hemicube: points per surface
  int hemicube = 0;             ///< resolution of the hemicubes, even; 0: cosine-distributed rays
  uint64_t seed = 1;
};

/// An upper bound for the standard error of a mean of `count` values in [0, 1] [Bhatia00], such as
/// the share of rays that hit: sqrt(F (1 - F) / count), with F and the count taken after two more
/// hits and two more misses [Agresti98]. So it does not vanish where nothing or everything was hit:
/// twice it is 2.8 / count then, the rule of three.
double standard_error_of_share(double share, double count);

/// By rays: F_ij = the share of cosine-distributed rays from points spread uniformly over the front
/// of i that meet the front of j first. The error is standard_error_of_share, an upper bound,
/// because the points are stratified.
/// By hemicube: hemicubes, each turned about its normal by a random angle, on points spread
/// likewise; the standard error is that of the mean over the points, and not less than if each
/// pixel were a ray. One point has no spread to tell by: standard_error_of_share of one value.
/// `scene` is what `surfaces` and `tracer` were made from; holes of its alpha masks are seen
/// through, so give one without where surfaces count as solid. Besides the matrix the memory is
/// sampled_factor_bytes. Members of a team share the rows out. Errors: cancelled, another member of
/// the team gives up.
Result<FactorMatrix> sampled_factors(const scene::Scene& scene, const Surfaces& surfaces,
                                     const trace::RayTracer& tracer, const SampledParams& params,
                                     const FactorSelection& selection, Progress& progress,
                                     Team* team = nullptr);

/// Memory of the sampling besides the matrix, for this number of surfaces.
uint64_t sampled_factor_bytes(size_t surfaces, const SampledParams& params);

/// Adds the factors from a point to each surface by one hemicube to `sums` (one per surface).
/// The cube is turned about the normal by `turn_rad`. Advances `progress` by the pixels; stops in
/// the middle when it is cancelled.
void add_hemicube_factors(const Surfaces& surfaces, const trace::RayTracer& tracer,
                          const Hemicube& cube, const trace::Ray& normal_ray, float turn_rad,
                          std::span<double> sums, Progress& progress);

/// Two polygons and what stands between them, to be traced: surface 0 is `a`, surface 1 is `b`.
scene::Scene scene_of_polygons(PolygonView a, PolygonView b, std::span<const Polygon> blockers);

/// F(a -> b) past blockers by rays or by hemicube, with its standard error.
struct SampledFactor {
  double value = 0, error = 0;
};
Result<SampledFactor> sampled_form_factor(PolygonView a, PolygonView b,
                                          std::span<const Polygon> blockers,
                                          const SampledParams& params);

/// F from a differential element at `point` to `b` past blockers, by `samples` cosine rays or by
/// one hemicube, whose error is bounded by that of a ray for each pixel.
Result<SampledFactor> sampled_point_factor(DVec3 point, DVec3 normal, PolygonView b,
                                           std::span<const Polygon> blockers,
                                           const SampledParams& params);

}  // namespace luxel::viewfactor
