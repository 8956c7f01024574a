// View factors by casting rays: independent of every formula.
#pragma once

#include <span>

#include "trace/ray_tracer.h"
#include "transport/factor_matrix.h"
#include "transport/hemicube.h"

namespace luxel::transport {

struct SampledParams {
  uint32_t samples = 1u << 18;  ///< by rays: rays per surface; by hemicube: points per surface
  int hemicube = 0;             ///< resolution of the hemicubes, even; 0: cosine-distributed rays
  uint64_t seed = 1;
};

/// By rays: F_ij = the share of cosine-distributed rays from points spread uniformly over the front
/// of i that meet the front of j first. The standard error is sqrt(F (1 - F) / samples), an upper
/// bound, because the points are stratified.
/// By hemicube: hemicubes, each turned about its normal by a random angle, on points spread
/// likewise; the standard error is that of the mean over the points. `scene` is what `surfaces` and
/// `tracer` were made from. Errors: cancelled.
Result<FactorMatrix> sampled_factors(const scene::Scene& scene, const Surfaces& surfaces,
                                     const trace::RayTracer& tracer, const SampledParams& params,
                                     const FactorSelection& selection, Progress& progress);

/// Adds the factors from a point to each surface by one hemicube to `sums` (one per surface).
/// The cube is turned about the normal by `turn_rad`.
void add_hemicube_factors(const Surfaces& surfaces, const trace::RayTracer& tracer,
                          const Hemicube& cube, const trace::Ray& normal_ray, float turn_rad,
                          std::span<double> sums);

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
/// one hemicube.
Result<SampledFactor> sampled_point_factor(DVec3 point, DVec3 normal, PolygonView b,
                                           std::span<const Polygon> blockers,
                                           const SampledParams& params);

}  // namespace luxel::transport
